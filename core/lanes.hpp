// Two doubles at a time, with the same results on every CPU.
#pragma once
#include <algorithm>

#if defined(__SSE2__)
#include <emmintrin.h>
#elif defined(__aarch64__)
#include <arm_neon.h>
#endif

namespace passo {

#if defined(__SSE2__)
struct Lanes {
  __m128d v;
  explicit Lanes(__m128d x) : v(x) {}
  explicit Lanes(double x) : v(_mm_set1_pd(x)) {}
  static Lanes load(const double* p) { return Lanes(_mm_loadu_pd(p)); }
  double least() const { return _mm_cvtsd_f64(_mm_min_sd(v, _mm_unpackhi_pd(v, v))); }
  double most() const { return _mm_cvtsd_f64(_mm_max_sd(v, _mm_unpackhi_pd(v, v))); }
};
inline Lanes operator-(Lanes a, Lanes b) { return Lanes(_mm_sub_pd(a.v, b.v)); }
inline Lanes operator*(Lanes a, Lanes b) { return Lanes(_mm_mul_pd(a.v, b.v)); }
inline Lanes min(Lanes a, Lanes b) { return Lanes(_mm_min_pd(a.v, b.v)); }
inline Lanes max(Lanes a, Lanes b) { return Lanes(_mm_max_pd(a.v, b.v)); }
#elif defined(__aarch64__)
struct Lanes {
  float64x2_t v;
  explicit Lanes(float64x2_t x) : v(x) {}
  explicit Lanes(double x) : v(vdupq_n_f64(x)) {}
  static Lanes load(const double* p) { return Lanes(vld1q_f64(p)); }
  double least() const { return vminvq_f64(v); }
  double most() const { return vmaxvq_f64(v); }
};
inline Lanes operator-(Lanes a, Lanes b) { return Lanes(vsubq_f64(a.v, b.v)); }
inline Lanes operator*(Lanes a, Lanes b) { return Lanes(vmulq_f64(a.v, b.v)); }
inline Lanes min(Lanes a, Lanes b) { return Lanes(vminq_f64(a.v, b.v)); }
inline Lanes max(Lanes a, Lanes b) { return Lanes(vmaxq_f64(a.v, b.v)); }
#else
struct Lanes {
  double a, b;
  Lanes(double x, double y) : a(x), b(y) {}
  explicit Lanes(double x) : a(x), b(x) {}
  static Lanes load(const double* p) { return Lanes(p[0], p[1]); }
  double least() const { return std::min(a, b); }
  double most() const { return std::max(a, b); }
};
inline Lanes operator-(Lanes x, Lanes y) { return Lanes(x.a - y.a, x.b - y.b); }
inline Lanes operator*(Lanes x, Lanes y) { return Lanes(x.a * y.a, x.b * y.b); }
inline Lanes min(Lanes x, Lanes y) { return Lanes(std::min(x.a, y.a), std::min(x.b, y.b)); }
inline Lanes max(Lanes x, Lanes y) { return Lanes(std::max(x.a, y.a), std::max(x.b, y.b)); }
#endif

}  // namespace passo
