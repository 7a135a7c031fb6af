// Motion filters of a machine: shapers of X, Y and Z, and pressure advance of the extruders.
#pragma once
#include <algorithm>
#include <cmath>
#include <vector>

namespace passo {

// An input shaper replaces the position x(t) by the sum of weight * x(t - at + mean), where `mean`
// is the sum of weight * at: a constant speed stays in place.
struct Impulse {
  bool operator==(const Impulse&) const = default;
  double weight, at;  // the weights add up to 1; at: s, the first one 0, ascending
};

// The filtered position depends on the past only: every motor follows the plan `delay` later, so
// that the earliest impulse needs only positions that are planned already. A cut of the plan and of
// the steps is then at one clock.
struct Filters {
  std::vector<Impulse> shapers[3];  // of X, Y and Z; empty: none
  std::vector<double> smooth_s;     // by extruder: half of the width over which the advance is
                                    // smoothed; 0: the extruder has no advance
  bool suspended = false;           // while homing and probing

  static double mean(const std::vector<Impulse>& shaper) {
    double sum = 0;
    for (const Impulse& i : shaper) sum += i.weight * i.at;
    return sum;
  }
  bool advances(size_t extruder) const {
    return !suspended && extruder < smooth_s.size() && smooth_s[extruder] > 0;
  }
  bool on() const {
    return !suspended &&
           (std::any_of(shapers, shapers + 3, [](const auto& s) { return !s.empty(); }) ||
            std::any_of(smooth_s.begin(), smooth_s.end(), [](double s) { return s > 0; }));
  }
  // Axes have different shapers, so the sum of their speeds differs from the plan.
  bool differ() const { return on() && (shapers[0] != shapers[1] || shapers[0] != shapers[2]); }
  // Whole ticks, so that clocks of the plan and of the steps are rounded alike.
  double delay(double hz) const {
    if (!on()) return 0;
    double s = 0;
    for (const auto& shaper : shapers) s = std::max(s, mean(shaper));
    for (double half : smooth_s) s = std::max(s, half);
    return std::ceil(s * hz);
  }
  // Ticks from the end of a move until the last motor is at rest.
  double memory(double hz) const {
    if (!on()) return 0;
    double s = 0;
    for (const auto& shaper : shapers)
      if (!shaper.empty()) s = std::max(s, shaper.back().at - mean(shaper));
    for (double half : smooth_s) s = std::max(s, half);
    return delay(hz) + std::ceil(s * hz);
  }
};

}  // namespace passo
