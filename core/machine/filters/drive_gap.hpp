// Gaps in the drives of X, Y and Z (backlash), which a motor closes after each turn. This filter
// acts on the law of the motor, after all kernels: filters/backlash.hpp.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>

#include "machine/filters/kernel.hpp"

namespace passo {

struct Gap {
  bool operator==(const Gap&) const = default;
  double mm = 0, over_mm = 1;  // over_mm: distance during which the motor closes the gap
  double share() const { return mm / over_mm; }  // additional speed meanwhile, as a fraction
};

struct DriveGaps {
  Gap of[3];  // of linear actuators; 0 mm: no compensation

  bool operator==(const DriveGaps&) const = default;
  bool on() const {
    return std::any_of(of, of + 3, [](const Gap& gap) { return gap.mm > 0; });
  }
  // The additional speed of a motor while it closes the gap of its drive, as a fraction. `row`: the
  // motor's factors for the axes.
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
