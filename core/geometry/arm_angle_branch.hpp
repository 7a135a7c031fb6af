// The direction of the nozzle from an arm's shoulder as an angle. The range of angles ends half a
// turn away from its middle, which the configuration gives, usually the direction of the bed's
// middle.
#pragma once
#include <cmath>

#include "base/numbers.hpp"

namespace passo {

// Whether an arm of two parts reaches a point d mm from its shoulder. An arm that is nearly
// stretched or folded does not count: it would have to turn too fast for any move.
inline bool arm_reaches(double d, double part1, double part2) {
  constexpr double kLeft = 0.01;  // mm
  return d >= std::fabs(part1 - part2) + kLeft && d <= part1 + part2 - kLeft;
}

class Facing {
 public:
  explicit Facing(double degrees) : middle_(degrees * (kPi / 180)) {
    sincos(middle_, sine_, cosine_);
  }
  // atan2, at most half a turn from the middle.
  double angle(double y, double x) const {
    double a = atan2(y, x);
    while (a <= middle_ - kPi) a += 2 * kPi;
    while (a > middle_ + kPi) a -= 2 * kPi;
    return a;
  }
  // Whether a straight line between two points crosses the end of the range of angles, or ends
  // there. A line in front of the shoulder cannot.
  bool jumps(double y0, double x0, double y1, double x1) const {
    if (x0 * cosine_ + y0 * sine_ > 0 && x1 * cosine_ + y1 * sine_ > 0) return false;
    double from = angle(y0, x0) - middle_, to = angle(y1, x1) - middle_;
    return std::fabs(to - from) > kPi || std::fmax(std::fabs(from), std::fabs(to)) > kPi - kEnd;
  }

 private:
  static constexpr double kEnd = 1e-9;  // within this, rounding decides on which side a point is
  double middle_, sine_, cosine_;
};

// Geometry::grain of an arm for a point x, y from its shoulder. It is small near the shoulder. If
// the parts have different lengths, it is also small near the circle on which they are folded.
inline double grain_at(double x, double y, double around, double difference) {
  double d = std::sqrt(x * x + y * y) - around, unfolded = d - std::fabs(difference);
  return unfolded > 0 ? std::sqrt(d * unfolded) : 0;
}

}  // namespace passo
