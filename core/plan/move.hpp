// A move on the timeline: a straight line with a trapezoid of speed.
#pragma once
#include <algorithm>
#include <cstdint>
#include <utility>

#include "base/types.hpp"
#include "machine/constraints.hpp"

namespace passo {

// Path measure `d`: Euclidean mm of X, Y, Z where these move, else the longest axis in mm; under
// the law `cornering_distance` the longest axis in steps, as APrinter plans. All speeds and
// accelerations below are of that measure, per second. The time law over the path position s:
//   s0 ≤ s: d_acc at acceleration a, d_cru at speed vc, the rest of d at deceleration b.
struct Move : MoveOrigin {
  double p0[kAxes], p1[kAxes];  // ends, mm
  double d;                     // path measure
  double v0, vc, v1, a, b;      // speeds at start, in cruise, at end; a, b > 0
  double d_acc, d_cru;          // lengths of the phases
  double start;                 // ticks since the start of the job
  double t_acc, t_cru, t_dec;   // duration, ticks
  double vn2, vj2;              // caps of v²: within the move; at its start
  double cruise_a;              // its highest speed that this acceleration reaches
  double deviation;             // junction deviation of its corners, mm
  double duty;                  // laser's fraction of full power: at 1 mm/s, or in a dwell
  double feed, duration, radius, fastest;  // as requested, kept for replanning
  double from_faster;   // deceleration from above its nominal speed, after a replan; 0: none
  double flow, owed;    // of MoveRequest; `owed` at its start
  double curved_steps;  // maximum steps of the nonlinear actuators
  double curved_bends;  // of these at constant speed: sum of √(steps/s²), by speed, at most
  double tolerance;     // ticks by which steps may miss their ideal times; 0: the board's own
  double advance;       // pressure advance of its filament, s
  double step_load, command_load;  // highest fraction of a board's budget; at most 1: within it
  float steps[kBudgets], commands[kBudgets];  // of a board's motors, as its budget calculates
  double ahead0, ahead1;  // commands ahead of the boards' rates at its start and end, at most
  uint32_t rules;         // number in the planner's RuleBook
  uint32_t records;       // timed records that are due at its start
  uint8_t step_budget, command_budget;  // the budgets of step_load and command_load
  LimitId speed_limit, accel_limit;
  MoveKind kind;
  uint8_t moved;
  uint8_t arc_axis;  // of MoveRequest
  bool inner;        // continues the same path: chord of an arc, split or cut move; no junction law
  bool rapid;
  bool cartesian;      // X, Y or Z moves
  bool unscaled;       // M220 does not apply
  bool advance_binds;  // the speed at its start is limited by the extruder's pressure advance

  double ticks() const { return t_acc + t_cru + t_dec; }
  double end() const { return start + ticks(); }
  // Distance and speed `tau` ticks after its start; `hz` ticks are a second.
  std::pair<double, double> along(double tau, double hz) const {
    double t0 = std::min(tau, t_acc) / hz, t1 = std::clamp(tau - t_acc, 0.0, t_cru) / hz;
    double t2 = std::clamp(tau - t_acc - t_cru, 0.0, t_dec) / hz;
    double s = v0 * t0 + 0.5 * a * t0 * t0 + vc * t1 + vc * t2 - 0.5 * b * t2 * t2;
    double v = t2 > 0 ? vc - b * t2 : tau > t_acc ? vc : v0 + a * t0;
    return {std::clamp(s, 0.0, d), v};
  }
};

}  // namespace passo
