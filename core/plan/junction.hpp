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

  // An extruder may change its speed at once by `jerk` mm/s, and so may further linear axes.
  double extruder_cap(const Move& before, const Move& m, const Constraints& own) const;

  // Junction deviation (S. Jeon, 2011, as in grbl): the corner is a circle that passes at most δ
  // from it, v² = a δ s / (1 - s) with s = sin(θ/2), θ the angle enclosed by the two moves. The
  // circle's tangent points must lie on the inner half of either move: v² ≤ ½ a d tan(θ/2).
  double deviation(const Move& before, const Move& m, double cap, double delta) const;

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
