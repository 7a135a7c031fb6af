// The window of each step: how far its execution may be from its ideal time.
#pragma once
#include "base/simd.hpp"

namespace passo {

// Distance in ticks to a step that does not exist or is not known.
inline constexpr double kNeverNear = 1e15;

// Half the window of step k is a quarter of the smaller gap to its neighbours, and at most
// `tolerance`. It is also small enough to keep executed steps `least` ticks apart. Half a tick is
// added, so that the window always contains an integer. Reads t[-1] and t[n].
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
