// Motion filters of a machine: shapers of X, Y and Z, a limit of jerk, pressure advance of the
// extruders, and backlash compensation.
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

// Above `mm_s` of filament, each further mm/s counts with the fraction `share` of the advance.
struct Knee {
  double mm_s, share;  // share: 0 to 1, at most that of the knee before it
};

// The gap in the drive of a motor, which is taken up over a distance after each turn.
struct Gap {
  double mm = 0, over_mm = 1;
  double share() const { return mm / over_mm; }  // fraction by which it is faster meanwhile
};

// The filtered position depends on the past only: every motor follows the plan `delay` later, so
// that the earliest impulse needs only positions that are planned already. A cut of the plan and of
// the steps is then at one clock.
struct Filters {
  std::vector<Impulse> shapers[3];       // of X, Y and Z; empty: none
  std::vector<double> smooth_s;          // by extruder: half of the width over which the advance is
                                         // smoothed; 0: the extruder has no advance
  std::vector<std::vector<Knee>> knees;  // by extruder, ascending; none: advanced in proportion
  std::vector<bool> shaped;              // by extruder: it follows the shapers of X and Y
  // The position of each axis and of the extruder is its mean over this time, s; 0: it is not. The
  // jerk of an axis is then its change of acceleration in this time, divided by it.
  double box_s = 0;
  Gap gaps[3];             // of actuators that are linear; 0 mm: not compensated
  bool suspended = false;  // while homing and probing

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
           (box_s > 0 || std::any_of(gaps, gaps + 3, [](const Gap& gap) { return gap.mm > 0; }) ||
            std::any_of(shapers, shapers + 3, [](const auto& s) { return !s.empty(); }) ||
            std::any_of(smooth_s.begin(), smooth_s.end(), [](double s) { return s > 0; }));
  }
  bool boxed() const { return !suspended && box_s > 0; }
  // The filament of this extruder follows a shaper of X or Y.
  bool shapes(size_t extruder) const {
    return !suspended && extruder < shaped.size() && shaped[extruder] &&
           !(shapers[0].empty() && shapers[1].empty());
  }
  // The advance is smoothed by boxes of these widths, s: a triangle, unless the box of all axes is
  // wider than half of it.
  double narrow_s(size_t extruder) const { return smooth_s[extruder]; }
  double wide_s(size_t extruder) const { return std::max(smooth_s[extruder], box_s); }
  // Axes have different shapers, so the sum of their speeds differs from the plan.
  bool differ() const { return on() && (shapers[0] != shapers[1] || shapers[0] != shapers[2]); }
  // The fraction by which a motor with this row of the axes is faster than the plan while it takes
  // up the gap of its drive.
  double share(const double* row) const {
    double share = 0;
    for (int j = 0; j < 3 && !suspended; ++j)
      if (row[j] != 0) share = std::max(share, gaps[j].share());
    return share;
  }
  // Whole ticks, one at least, so that clocks of the plan and of the steps are rounded alike.
  double delay(double hz) const {
    if (!on()) return 0;
    double s = 0.5 * box_s, of_plane = 0;
    for (const auto& shaper : shapers) s = std::max(s, 0.5 * box_s + mean(shaper));
    for (int j = 0; j < 2; ++j) of_plane = std::max(of_plane, mean(shapers[j]));
    return std::max(std::ceil(std::max(s, widest_s(of_plane)) * hz), 1.0);
  }
  // Ticks from the end of a move until the last motor is at rest.
  double memory(double hz) const {
    if (!on()) return 0;
    double s = 0.5 * box_s, of_plane = 0;
    for (int j = 0; j < 3; ++j) {
      if (shapers[j].empty()) continue;
      const double after = shapers[j].back().at - mean(shapers[j]);
      s = std::max(s, 0.5 * box_s + after);
      if (j < 2) of_plane = std::max(of_plane, after);
    }
    return delay(hz) + std::ceil(std::max(s, widest_s(of_plane)) * hz);
  }

 private:
  // Half of the time over which the advance of an extruder is smoothed, at most; longer by
  // `of_plane` if it follows the shapers of X and Y.
  double widest_s(double of_plane) const {
    double s = 0;
    for (size_t i = 0; i < smooth_s.size(); ++i)
      if (smooth_s[i] > 0)
        s = std::max(s, 0.5 * (wide_s(i) + narrow_s(i)) + (shapes(i) ? of_plane : 0));
    return s;
  }
};

}  // namespace passo
