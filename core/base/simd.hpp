// Vector clones of hot loops where the toolchain has them. All clones give the same bits: the build
// forbids contraction, and only correctly rounded operations are used.
#pragma once
#include <bit>
#include <cstdint>

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && defined(__linux__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(PASSO_NO_CLONES)
#define PASSO_SIMD __attribute__((target_clones("default", "arch=x86-64-v3")))
// Functions written twice, one of them for AVX2, are chosen between when the program runs.
#define PASSO_CHOOSES 1
#else
#define PASSO_SIMD
#endif
// A function that a cloned function calls must be part of it to be cloned with it.
#define PASSO_INLINE __attribute__((always_inline)) inline
#define PASSO_INLINE_AVX2 __attribute__((always_inline, target("avx2"))) inline

namespace passo {

// The next multiple of four, so that such a loop has no remainder. Its arrays must extend that far;
// the numbers there do not matter.
constexpr int in_fours(int n) { return (n + 3) & ~3; }

// Adding this moves the integer part of |x| < 2^51 into the low bits, rounded half to even.
inline constexpr double kRoundMagic = 6755399441055744.0;
inline double round_even(double x) { return (x + kRoundMagic) - kRoundMagic; }

}  // namespace passo
