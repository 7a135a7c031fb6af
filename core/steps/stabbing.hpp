// Finds the longest command (interval, count, add) that keeps every step within its window.
//
// Step m (0-based) of a command is executed (m+1) I + m(m+1)/2 A ticks after the step before the
// command. Divided by m+1 this is the line I + A x at x = m/2. It must cross all the vertical
// segments [lo_m, hi_m] / (m+1): the stabbing-line problem (O'Rourke, "An on-line algorithm for
// fitting straight lines between data ranges", 1981). For the first steps the search keeps the
// exact range of possible slopes, from all pairs of segments, four at a time. When the range
// contains only a few integers, it tries each of them as far as it goes.
#pragma once
#include <stdexcept>

#include "base/lanes.hpp"
#include "base/simd.hpp"
#include "base/wide_lanes.hpp"

namespace passo {

struct Command {
  int count;
  double interval, add;  // integers

  // Duration in ticks, an integer. Throws if a board would refuse the command.
  double span() const {
    const double n = count;
    if (interval < 1 || interval + add * (n - 1) < 1 || interval > 0x7fffffff)
      throw std::logic_error("a command without time between its steps");
    return interval * n + add * (0.5 * n * (n - 1));
  }
};

// Errors of executed steps: the largest, the sum of squares, and the largest distance outside of a
// window. The last one is negative if all steps are within their windows.
struct Errors {
  double largest = 0, square = 0, beyond = -1;
};

inline constexpr int kMaxSteps = 4096;  // limit here; the protocol allows 65535

struct StabbingTables {
  double reciprocal[kMaxSteps + 4] = {};  // [i] = 1/i
  double halves[24] = {};                 // 0, ½, 1 …
  double beyond[8] = {};                  // 0 four times, then a large number
  double counts[4] = {1, 2, 3, 4};
  double triangles[4] = {0, 1, 3, 6};  // m(m + 1)/2
  constexpr StabbingTables() {
    for (int i = 1; i < kMaxSteps + 4; ++i) reciprocal[i] = 1.0 / i;
    for (int m = 0; m < 24; ++m) halves[m] = 0.5 * m;
    for (int k = 4; k < 8; ++k) beyond[k] = 1e300;
  }
};
inline constexpr StabbingTables kStabbing;

// The code after the blocks is a separate function, so that both can use all registers.
namespace pairs {
using Vector = Lanes;
#define PASSO_SEARCH_INLINE PASSO_INLINE
#define PASSO_SEARCH_APART [[gnu::noinline]]
#include "steps/stabbing_search.hpp"
#undef PASSO_SEARCH_INLINE
#undef PASSO_SEARCH_APART
}  // namespace pairs

#if defined(PASSO_CHOOSES) || defined(__AVX2__)
namespace wide {
using Vector = WideLanes;
#define PASSO_SEARCH_INLINE PASSO_INLINE_AVX2
#define PASSO_SEARCH_APART [[gnu::noinline, gnu::target("avx2")]]
#include "steps/stabbing_search.hpp"
#undef PASSO_SEARCH_INLINE
#undef PASSO_SEARCH_APART
}  // namespace wide
#endif

class Stabbing {
 public:
  // Finds the longest command for n steps, n ≤ kMaxSteps. Step m must be executed at an integer
  // time from lo[m] to hi[m], and each window must contain an integer. `last` is the time of the
  // step before. The times of the command's steps are written to `executed`. All three arrays must
  // extend to the next multiple of four after n. There `lo` and `hi` may contain any numbers, and
  // `executed` may be overwritten.
  Command longest(const double* lo, const double* hi, int n, double last, double* executed) {
#if defined(PASSO_CHOOSES)
    return has_avx2_ ? longest_avx2(lo, hi, n, last, executed)
                     : longest_baseline(lo, hi, n, last, executed);
#else
    return search_.longest(lo, hi, n, last, executed);
#endif
  }

  // Errors of n executed steps with the ideal times t and the windows lo … hi.
  Errors errors(const double* t, const double* lo, const double* hi, const double* executed,
                size_t n) const {
#if defined(PASSO_CHOOSES)
    return has_avx2_ ? errors_avx2(t, lo, hi, executed, n)
                     : baseline_.errors(t, lo, hi, executed, n);
#else
    return search_.errors(t, lo, hi, executed, n);
#endif
  }

 private:
#if defined(PASSO_CHOOSES)
  pairs::Search baseline_;
  wide::Search avx2_;
  bool has_avx2_ = __builtin_cpu_supports("avx2");

  [[gnu::noinline]] Command longest_baseline(const double* lo, const double* hi, int n, double last,
                                             double* executed) {
    return baseline_.longest(lo, hi, n, last, executed);
  }
  [[gnu::noinline, gnu::target("avx2")]] Errors errors_avx2(const double* t, const double* lo,
                                                            const double* hi,
                                                            const double* executed,
                                                            size_t n) const {
    return avx2_.errors(t, lo, hi, executed, n);
  }
  [[gnu::noinline, gnu::target("avx2")]] Command longest_avx2(const double* lo, const double* hi,
                                                              int n, double last,
                                                              double* executed) {
    return avx2_.longest(lo, hi, n, last, executed);
  }
#elif defined(__AVX2__)
  wide::Search search_;
#else
  pairs::Search search_;
#endif
};

}  // namespace passo
