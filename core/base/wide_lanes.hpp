// Four doubles in one register, for CPUs with AVX2: the same operations as Lanes, the same results.
#pragma once
#include "base/simd.hpp"

#if defined(PASSO_CHOOSES) || defined(__AVX2__)
#include <immintrin.h>

namespace passo {

struct WideLanes {
  __m256d v;
  PASSO_INLINE_AVX2 explicit WideLanes(__m256d x) : v(x) {}
  PASSO_INLINE_AVX2 explicit WideLanes(double x) : v(_mm256_set1_pd(x)) {}
  PASSO_INLINE_AVX2 static WideLanes load(const double* p) { return WideLanes(_mm256_loadu_pd(p)); }
  PASSO_INLINE_AVX2 void store(double* p) const { _mm256_storeu_pd(p, v); }
  PASSO_INLINE_AVX2 double least() const {
    __m128d half = _mm_min_pd(_mm256_castpd256_pd128(v), _mm256_extractf128_pd(v, 1));
    return _mm_cvtsd_f64(_mm_min_sd(half, _mm_unpackhi_pd(half, half)));
  }
  PASSO_INLINE_AVX2 double most() const {
    __m128d half = _mm_max_pd(_mm256_castpd256_pd128(v), _mm256_extractf128_pd(v, 1));
    return _mm_cvtsd_f64(_mm_max_sd(half, _mm_unpackhi_pd(half, half)));
  }
  PASSO_INLINE_AVX2 WideLanes last() const { return WideLanes(_mm256_permute4x64_pd(v, 0xff)); }
};
PASSO_INLINE_AVX2 WideLanes operator-(WideLanes x, WideLanes y) {
  return WideLanes(_mm256_sub_pd(x.v, y.v));
}
PASSO_INLINE_AVX2 WideLanes operator+(WideLanes x, WideLanes y) {
  return WideLanes(_mm256_add_pd(x.v, y.v));
}
PASSO_INLINE_AVX2 WideLanes operator*(WideLanes x, WideLanes y) {
  return WideLanes(_mm256_mul_pd(x.v, y.v));
}
PASSO_INLINE_AVX2 WideLanes min(WideLanes x, WideLanes y) {
  return WideLanes(_mm256_min_pd(x.v, y.v));
}
PASSO_INLINE_AVX2 WideLanes max(WideLanes x, WideLanes y) {
  return WideLanes(_mm256_max_pd(x.v, y.v));
}
template <int n>
PASSO_INLINE_AVX2 WideLanes slide(WideLanes x, WideLanes y) {
  __m256d middle = _mm256_permute2f128_pd(x.v, y.v, 0x21);
  if constexpr (n == 1) return WideLanes(_mm256_shuffle_pd(middle, y.v, 5));
  if constexpr (n == 2) return WideLanes(middle);
  if constexpr (n == 3) return WideLanes(_mm256_shuffle_pd(x.v, middle, 5));
}
PASSO_INLINE_AVX2 unsigned above(WideLanes x, WideLanes y) {
  return unsigned(_mm256_movemask_pd(_mm256_cmp_pd(x.v, y.v, _CMP_GT_OQ)));
}

}  // namespace passo
#endif
