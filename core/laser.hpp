// A laser whose power follows the speed of the head, so that each millimetre gets the same energy.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "move.hpp"

namespace passo {

// Calls value_at(ticks, mean) for consecutive slices of a move: from `ticks` on, until the next,
// the path speed has this mean (units of the move's path measure a second). Ramps are cut into
// equal slices of at most kLaserSlice seconds; at constant speed one slice does.
inline constexpr double kLaserSlice = 0.005;

template <class F>
void each_speed(const Move& m, double hz, F value_at) {
  auto ramp = [&](double from, double ticks, double speed, double change) {
    if (ticks <= 0) return;
    double n = std::max(1.0, std::ceil(ticks / (kLaserSlice * hz)));
    for (double k = 0; k < n; ++k)
      value_at(from + ticks * k / n,
               std::max(0.0, speed + change * (ticks / hz) * ((k + 0.5) / n)));
  };
  ramp(m.start, m.t_acc, m.v0, m.a);
  if (m.t_cru > 0) value_at(m.start + m.t_acc, m.vc);
  ramp(m.start + m.t_acc + m.t_cru, m.t_dec, m.vc, -m.b);
}

}  // namespace passo
