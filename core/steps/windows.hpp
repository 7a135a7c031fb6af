// How far each step may be from its ideal time.
#pragma once
#include "base/simd.hpp"

namespace passo {

// Ticks from a step to one that is not known, or that there is none.
inline constexpr double kNeverNear = 1e15;

// half[k] = half the window of step k: a quarter of the smaller gap to its neighbours, `tolerance`
// at most, and so that executed steps keep `least` ticks apart; plus half a tick, so that it always
// holds an integer. t[-1] and t[n] are read.
PASSO_SIMD inline void windows(const double* __restrict t, double* __restrict lo,
                               double* __restrict hi, int n, double tolerance, double least) {
  for (int k = 0; k < n; ++k) {
    double before = t[k] - t[k - 1], after = t[k + 1] - t[k];
    double gap = before < after ? before : after;
    double quarter = 0.25 * gap, room = 0.5 * (gap - least);
    double half = quarter < room ? quarter : room;
    half = half < tolerance ? half : tolerance;
    half = (half > 0 ? half : 0) + 0.5;
    lo[k] = t[k] - half;
    hi[k] = t[k] + half;
  }
}

}  // namespace passo
