// How fast the machine may go through the corner between two moves.
#pragma once
#include "machine/constraints.hpp"
#include "machine/machine.hpp"
#include "plan/move.hpp"
#include "plan/move_limits.hpp"

namespace passo {

class JunctionRule {
 public:
  explicit JunctionRule(const Machine& m) : machine_(m) {}

  // The junction deviation of a move with this acceleration: that with which a right angle is taken
  // at the speed `square_corner`, or the one of the machine.
  static double deviation(const Limits& limits, double accel) {
    constexpr double kRootOf2 = 1.41421356237309504880;
    if (limits.junction != JunctionLaw::square_corner) return limits.junction_deviation;
    return limits.square_corner * limits.square_corner * (kRootOf2 - 1) / accel;
  }

  // Steps of axis slot j in the move, unsigned and unrounded: the measure of `cornering_distance`.
  double steps(const Move& m, int j) const;

  // Cap of v² at the join of `before` and `m`, whose vn2, a and d are known.
  double cap2(const Move& before, const Move& m, const Rules& rules) const;
  // The same cap for an extruder whose advance changes there at once, by as many mm as it pushes
  // more or less a second, times the advance in s. Smoothed by a triangle of half width h, a change
  // by c adds c/h to its speed and c/h² to its acceleration.
  double advance_cap2(const Move& before, const Move& m, const Rules& rules) const;

 private:
  const Machine& machine_;

  static double unit(const Move& m, int j) { return (m.p1[j] - m.p0[j]) / m.d; }

  // Both moves drive the same axes without X, Y and Z, in the same proportion: no corner at all.
  bool alongside(const Move& before, const Move& m) const;

  // The cap of v² for extruders and further linear axes, which may change their speed at once by
  // `jerk` mm/s.
  double extruder_cap(const Move& before, const Move& m, const Constraints& own) const;

  // Junction deviation (S. Jeon, 2011, as in grbl): the corner is a circle that passes at most δ
  // from it, v² = a δ s / (1 - s) with s = sin(θ/2), θ the angle enclosed by the two moves. The
  // circle's tangent points must lie on the inner half of either move: v² ≤ ½ a d tan(θ/2).
  // Of the two moves the smaller a δ counts.
  double deviation(const Move& before, const Move& m, double cap) const;

  // APrinter (facts: v² = min over axes of a_i c_i / |m_i - m_i before|, m_i = steps of the axis by
  // steps of the longest axis, c_i = cornering distance in steps).
  double cornering(const Move& before, const Move& m, double cap) const;

  // The scale of the motor of axis slot j in this move, as M92 has set it; 0 if it has none.
  double steps_per_mm(const Move& m, int j) const;

  // Classic jerk: at the lesser nominal speed, no axis may change its speed by more than its jerk;
  // on a reversal of the axis the larger of the two speeds counts.
  double jerk(const Move& before, const Move& m, double cap, const Constraints& own) const;
};

}  // namespace passo
