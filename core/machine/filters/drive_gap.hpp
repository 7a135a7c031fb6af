// Gaps in the drives of X, Y and Z (backlash), which a motor takes up after each turn. They act on
// the law of the motor, after all kernels: filters/backlash.hpp.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>

#include "machine/filters/kernel.hpp"

namespace passo {

struct Gap {
  bool operator==(const Gap&) const = default;
  double mm = 0, over_mm = 1;                    // over_mm: the distance over which it is taken up
  double share() const { return mm / over_mm; }  // fraction by which the motor is faster meanwhile
};

struct DriveGaps {
  Gap of[3];  // of actuators that are linear; 0 mm: not taken up

  bool operator==(const DriveGaps&) const = default;
  bool on() const {
    return std::any_of(of, of + 3, [](const Gap& gap) { return gap.mm > 0; });
  }
  // The fraction by which a motor with this row of the axes is faster than the plan while it takes
  // up the gap of its drive.
  double share(const double* row) const {
    double share = 0;
    for (int j = 0; j < 3; ++j)
      if (row[j] != 0) share = std::max(share, of[j].share());
    return share;
  }

  static auto settings() {
    return std::array<Setting<DriveGaps>, 1>{{
        {"gaps",
         [](DriveGaps& f, size_t axis, const Numbers& n) {
           if (n.size() != 2 || !(n[0] >= 0 && n[0] <= n[1] && n[1] > 0 && std::isfinite(n[1])))
             throw std::invalid_argument("no such gap, or no such distance");
           f.of[axis_of(axis)] = {n[0], n[1]};
         }},
    }};
  }
};

}  // namespace passo
