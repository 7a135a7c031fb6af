// The load limits of one board's processor and its link, as limits of moves. The calculation uses
// only the moves in their order and the motors of the board, not the results of the compressor.
#pragma once
#include <algorithm>
#include <cmath>
#include <vector>

#include "machine/constraints.hpp"
#include "machine/machine.hpp"
#include "plan/move.hpp"

namespace passo {

// The rate of steps bounds the speed of each move. The rate of commands may be exceeded for a
// burst, which the board's slots take up; beyond it a move's steps may be farther from their ideal
// times, which saves commands, and if that is not enough it gets slower. The calculation assumes
// that a move ends as fast as it begins; the difference is corrected with the next move.
class BoardBudget {
 public:
  // Commands of a motor for a move: the first figure for each second; for each second of
  // acceleration, the second figure times the square root of the acceleration in steps/s²; for the
  // change of direction at its start, the third figure times the square root of the steps that this
  // change makes within the move, but at most the fourth figure. The total is never more than the
  // steps of the move. Fitted to circles and random paths of 0.02 to 3 mm a move, 5 to 300 mm/s,
  // 1000 to 20000 mm/s², at 2 µs; at 25 µs what grows with a root is half.
  static constexpr double kPerSecond = 20, kPerRampSecond = 1.1, kPerTurn = 3, kMaxPerTurn = 1.5;
  // The same where a nonlinear actuator accelerates along a straight line at constant speed. A
  // rotary delta's lines of 24 mm need that much, a delta's of 60 mm 0.7.
  static constexpr double kPerBendSecond = 0.9;
  // Each commit contains the steps with which a moving motor would brake: one command, plus this
  // figure times the speed times the square root of steps/mm divided by the acceleration. Nine were
  // measured with two motors at 60 mm/s, 22 with one at 250 mm/s, and 33 on a delta.
  static constexpr double kPerBrake = 0.5;
  // The factor by which motion filters increase the number of commands, because they change the
  // acceleration more often. 1.22 were measured on a print with shapers and advance, 1.27 on one of
  // a CoreXY.
  static constexpr double kFiltered = 1.3;

  // `index` is that of the budget in the machine.
  BoardBudget(const Machine& machine, uint8_t index);

  // The machine has another geometry of the same kind.
  void use_geometry();

  bool bounds_anything() const {
    return budget_.step_rate < kInfinity || budget_.command_rate < kInfinity;
  }

  // The next move begins with speed² `start2`, not where the last one ended.
  void restart(double start2);
  // Commands ahead of the rate: the free space in the board's move queue, for any cut of the plan.
  void set_ahead(double commands) { ahead_ = commands; }
  double ahead() const { return ahead_; }
  const Budget& budget() const { return budget_; }
  // The machine is at standstill for this time.
  void rest(double seconds);

  // The machine dwells for this time after the move before.
  void dwell(double seconds);
  // Tightens vn2 of a move to the rate of steps.
  void bound_steps(Move& m);
  // After `bound_steps` of all boards: tightens vn2 and widens the tolerance of a move to the rate
  // of commands; its start has at most speed² `start2`.
  void charge(Move& m, double start2);

 private:
  // A move in the least time, between two speeds, and how long it accelerates.
  struct Shape {
    double start2, end2, most2, a, d;  // speeds²
    double peak, ramp_s, seconds;
    Shape() = default;
    Shape(const Move& m, double start2, double most2)
        : start2(std::min(start2, most2)), end2(this->start2), most2(most2), a(m.a), d(m.d) {
      time();
    }
    void time() {
      double mean2 = 0.5 * (start2 + end2);
      double peak2 = std::max({start2, end2, std::min(most2, mean2 + a * d)});
      double start = std::sqrt(start2);
      peak = std::sqrt(peak2);
      ramp_s = (2 * peak - start - (end2 == start2 ? start : std::sqrt(end2))) / a;
      seconds = ramp_s + std::max(0.0, d - (peak2 - mean2) / a) / peak;
    }
  };

  // A motor, and its steps in the move at hand where they are even along it.
  struct Motor {
    const StepperSpec* spec;  // its scale may change at standstill
    double c[3];
    int axis;   // ≥ 0: this axis alone drives it
    int joint;  // ≥ 0: a nonlinear actuator, even only where positions are those of the actuators
    double steps = 0, turn = 0;  // turn: steps beyond what the slope of the move before would be
    double slope = 0;            // steps/mm
    double count(const Move& m, bool joints) {
      double distance = 0;
      if (joint >= 0)
        distance = joints ? m.p1[joint] - m.p0[joint] : 0;
      else if (axis < 0)
        for (int j = 0; j < 3; ++j) distance += c[j] * (m.p1[j] - m.p0[j]);
      else if (axis != kE || m.extruder == spec->index)
        distance = m.p1[axis] - m.p0[axis];
      double signed_steps = distance * spec->steps_per_unit, was = slope;
      slope = signed_steps / m.d;
      turn = std::fabs(signed_steps - was * m.d);
      return steps = std::fabs(signed_steps);
    }
  };

  const Machine& machine_;
  std::vector<Motor> motors_;
  Budget budget_;
  uint8_t index_;
  double own_tolerance_, widest_, saving_;  // saving: commands at own / commands at widest
  LimitId limit_;
  int curved_motors_ = 0;
  double reach2_ = 0;  // speed² that the move before reaches at most
  double ahead_ = 0;   // commands beyond the rate

  // Of a motor in the move at hand, or of all that are curved: commands for the turn and for
  // bends, in each second of acceleration, and to brake at 1 mm/s.
  struct Need {
    double steps, motors, turn, bends, per_ramp_s, brake;
  };
  std::vector<Need> needs_;
  Shape last_{};
  double last_per_s_ = 0;  // as `per_ramp_s` below, of the move before

  // Commands of a move, and how many more they are for each second more of acceleration.
  struct Asked {
    double commands, per_ramp_s = 0;
  };
  Asked ask(const Move& m, const Shape& s, double saving) const;
  void list_needs(const Move& m);

  // The move before ends at this speed².
  void settle(double end2);

  // The largest at which `fits`, from 0 to `most`, and a thousand-millionth of that more.
  template <class Fits>
  static double largest(double most, Fits fits);

  void spend(Move& m, double start2);
};

}  // namespace passo
