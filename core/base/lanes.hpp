// Four doubles at a time, with the same results on every CPU.
#pragma once
#include <algorithm>

#include "base/simd.hpp"

#if defined(__SSE2__)
#include <emmintrin.h>
#elif defined(__aarch64__)
#include <arm_neon.h>
#endif

namespace passo {

// Two doubles. slide(a, b) = {a[1], b[0]}; above(a, b): bit k is set if a[k] > b[k].
#if defined(__SSE2__)
struct Pair {
  __m128d v;
  PASSO_INLINE explicit Pair(__m128d x) : v(x) {}
  PASSO_INLINE explicit Pair(double x) : v(_mm_set1_pd(x)) {}
  PASSO_INLINE static Pair load(const double* p) { return Pair(_mm_loadu_pd(p)); }
  PASSO_INLINE void store(double* p) const { _mm_storeu_pd(p, v); }
  PASSO_INLINE double least() const { return _mm_cvtsd_f64(_mm_min_sd(v, _mm_unpackhi_pd(v, v))); }
  PASSO_INLINE double most() const { return _mm_cvtsd_f64(_mm_max_sd(v, _mm_unpackhi_pd(v, v))); }
};
PASSO_INLINE Pair operator-(Pair a, Pair b) { return Pair(_mm_sub_pd(a.v, b.v)); }
PASSO_INLINE Pair operator+(Pair a, Pair b) { return Pair(_mm_add_pd(a.v, b.v)); }
PASSO_INLINE Pair operator*(Pair a, Pair b) { return Pair(_mm_mul_pd(a.v, b.v)); }
PASSO_INLINE Pair min(Pair a, Pair b) { return Pair(_mm_min_pd(a.v, b.v)); }
PASSO_INLINE Pair max(Pair a, Pair b) { return Pair(_mm_max_pd(a.v, b.v)); }
PASSO_INLINE Pair slide(Pair a, Pair b) { return Pair(_mm_shuffle_pd(a.v, b.v, 1)); }
PASSO_INLINE Pair second(Pair a) { return Pair(_mm_unpackhi_pd(a.v, a.v)); }
PASSO_INLINE unsigned above(Pair a, Pair b) {
  return unsigned(_mm_movemask_pd(_mm_cmpgt_pd(a.v, b.v)));
}
#elif defined(__aarch64__)
struct Pair {
  float64x2_t v;
  PASSO_INLINE explicit Pair(float64x2_t x) : v(x) {}
  PASSO_INLINE explicit Pair(double x) : v(vdupq_n_f64(x)) {}
  PASSO_INLINE static Pair load(const double* p) { return Pair(vld1q_f64(p)); }
  PASSO_INLINE void store(double* p) const { vst1q_f64(p, v); }
  PASSO_INLINE double least() const { return vminvq_f64(v); }
  PASSO_INLINE double most() const { return vmaxvq_f64(v); }
};
PASSO_INLINE Pair operator-(Pair a, Pair b) { return Pair(vsubq_f64(a.v, b.v)); }
PASSO_INLINE Pair operator+(Pair a, Pair b) { return Pair(vaddq_f64(a.v, b.v)); }
PASSO_INLINE Pair operator*(Pair a, Pair b) { return Pair(vmulq_f64(a.v, b.v)); }
PASSO_INLINE Pair min(Pair a, Pair b) { return Pair(vminq_f64(a.v, b.v)); }
PASSO_INLINE Pair max(Pair a, Pair b) { return Pair(vmaxq_f64(a.v, b.v)); }
PASSO_INLINE Pair slide(Pair a, Pair b) { return Pair(vextq_f64(a.v, b.v, 1)); }
PASSO_INLINE Pair second(Pair a) { return Pair(vdupq_laneq_f64(a.v, 1)); }
PASSO_INLINE unsigned above(Pair a, Pair b) {
  uint64x2_t c = vcgtq_f64(a.v, b.v);
  return unsigned(vgetq_lane_u64(c, 0) & 1) | unsigned(vgetq_lane_u64(c, 1) & 2);
}
#else
struct Pair {
  double a, b;
  Pair(double x, double y) : a(x), b(y) {}
  explicit Pair(double x) : a(x), b(x) {}
  static Pair load(const double* p) { return Pair(p[0], p[1]); }
  void store(double* p) const { p[0] = a, p[1] = b; }
  double least() const { return std::min(a, b); }
  double most() const { return std::max(a, b); }
};
inline Pair operator-(Pair x, Pair y) { return Pair(x.a - y.a, x.b - y.b); }
inline Pair operator+(Pair x, Pair y) { return Pair(x.a + y.a, x.b + y.b); }
inline Pair operator*(Pair x, Pair y) { return Pair(x.a * y.a, x.b * y.b); }
inline Pair min(Pair x, Pair y) { return Pair(std::min(x.a, y.a), std::min(x.b, y.b)); }
inline Pair max(Pair x, Pair y) { return Pair(std::max(x.a, y.a), std::max(x.b, y.b)); }
inline Pair slide(Pair x, Pair y) { return Pair(x.b, y.a); }
inline Pair second(Pair x) { return Pair(x.b); }
inline unsigned above(Pair x, Pair y) { return unsigned(x.a > y.a) | unsigned(x.b > y.b) << 1; }
#endif

struct Lanes {
  Pair a, b;
  PASSO_INLINE Lanes(Pair x, Pair y) : a(x), b(y) {}
  PASSO_INLINE explicit Lanes(double x) : a(x), b(x) {}
  PASSO_INLINE static Lanes load(const double* p) { return {Pair::load(p), Pair::load(p + 2)}; }
  PASSO_INLINE void store(double* p) const { a.store(p), b.store(p + 2); }
  PASSO_INLINE double least() const { return min(a, b).least(); }
  PASSO_INLINE double most() const { return max(a, b).most(); }
  PASSO_INLINE Lanes last() const { return {second(b), second(b)}; }
};
PASSO_INLINE Lanes operator-(Lanes x, Lanes y) { return {x.a - y.a, x.b - y.b}; }
PASSO_INLINE Lanes operator+(Lanes x, Lanes y) { return {x.a + y.a, x.b + y.b}; }
PASSO_INLINE Lanes operator*(Lanes x, Lanes y) { return {x.a * y.a, x.b * y.b}; }
PASSO_INLINE Lanes min(Lanes x, Lanes y) { return {min(x.a, y.a), min(x.b, y.b)}; }
PASSO_INLINE Lanes max(Lanes x, Lanes y) { return {max(x.a, y.a), max(x.b, y.b)}; }
// Bit k is set if x[k] > y[k].
template <int n>
PASSO_INLINE Lanes slide(Lanes x, Lanes y) {
  if constexpr (n == 1) return {slide(x.b, y.a), slide(y.a, y.b)};
  if constexpr (n == 2) return {x.b, y.a};
  if constexpr (n == 3) return {slide(x.a, x.b), slide(x.b, y.a)};
}
// Bit k is set if x[k] > y[k].
PASSO_INLINE unsigned above(Lanes x, Lanes y) { return above(x.a, y.a) | above(x.b, y.b) << 2; }

}  // namespace passo
