// What a board's processor and its link can take, as limits of moves. Everything here follows from
// the moves in their order; nothing comes back from the compressor.
#pragma once
#include <algorithm>
#include <cmath>
#include <vector>

#include "constraints.hpp"
#include "machine.hpp"
#include "move.hpp"

namespace passo {

// The rate of steps bounds the speed of each move. The rate of commands may be exceeded for a
// burst, which the board's slots take up; beyond it a move's steps may be farther from their ideal
// times, which saves commands, and if that is not enough it gets slower.
class MoveBudget {
 public:
  // Commands of a motor for a move: so many, and more while its speed changes, in each second the
  // second figure times the root of its acceleration in steps/s²; but never more than its steps.
  // Fitted at 2 µs to random and curved paths of 0.02 to 1 mm a move, 3000 and 20000 mm/s².
  static constexpr double kPerMove = 2, kPerRampSecond = 0.6;
  // The same where a nonlinear actuator accelerates along a straight line at constant speed: 0.7 on
  // lines of 60 mm at 80 mm/s on a delta.
  static constexpr double kPerBendSecond = 0.8;

  explicit MoveBudget(const Machine& machine)
      : machine_(machine), budget_(machine.budget), own_tolerance_(machine.tolerance),
        widest_(machine.widest_tolerance()),
        saving_(std::sqrt(std::sqrt(widest_ / own_tolerance_))),
        limit_(machine.budget.by_link ? kLink : kBoard) {
    for (const StepperSpec& s : machine.steppers) {
      Motor motor{&s, {}, -1, -1, 0};
      if (s.drive != Drive::actuator)
        motor.axis = s.drive == Drive::axis ? slot_of_axis(s.index) : int(kE);
      else if (!machine.geometry->linear(s.index, motor.c))
        motor.joint = s.index, ++curved_motors_;
      motors_.push_back(motor);
    }
  }

  bool bounds_anything() const {
    return budget_.step_rate < kInfinity || budget_.command_rate < kInfinity;
  }

  // The next move begins with speed² `start2`, not where the last one ended.
  void restart(double start2) { reach2_ = start2; }
  // Commands ahead of the rate: what the board's slots still hold, however the plan was cut.
  void set_ahead(double commands) { ahead_ = commands; }
  // The machine stands for so long.
  void rest(double seconds) {
    if (budget_.command_rate < kInfinity)
      ahead_ = std::max(0.0, ahead_ - budget_.command_rate * seconds);
  }

  // Tightens vn2 and widens the tolerance of a move; its start has at most speed² `start2`.
  void apply(Move& m, double start2) {
    m.ahead0 = ahead_;
    charge(m, start2);
    m.ahead1 = ahead_;
  }

 private:
  void charge(Move& m, double start2) {
    if (m.kind == MoveKind::dwell) {
      reach2_ = 0;
      rest(m.duration);
      return;
    }
    double steps = m.curved_steps;
    for (Motor& motor : motors_) steps += motor.count(m, machine_.joints);
    m.steps = steps;
    double most = budget_.step_rate * m.d;  // at this, speed × steps
    if (m.vn2 * steps * steps > most * most) {
      m.step_load = std::sqrt(m.vn2) * steps / most;
      m.vn2 = (most / steps) * (most / steps);
      m.speed_limit = kBoard;
    }
    start2 = std::min({start2, reach2_, m.vn2});
    Soonest soonest(m, start2);
    if (budget_.command_rate < kInfinity) spend(m, soonest, start2);
    reach2_ = soonest.end2;
  }

  // A move in the least time: it starts at speed² start2 and never brakes.
  struct Soonest {
    double end2, ramp_s, seconds;
    Soonest(const Move& m, double start2) {
      double start = std::sqrt(start2);
      end2 = std::min(m.vn2, start2 + 2 * m.a * m.d);
      double end = std::sqrt(end2);
      ramp_s = (end - start) / m.a;
      seconds = ramp_s + std::max(0.0, m.d - (end2 - start2) / (2 * m.a)) / end;
    }
  };

  // A motor, and its steps in the move at hand where they are even along it.
  struct Motor {
    const StepperSpec* spec;  // its scale may change while the machine stands
    double c[3];
    int axis;   // ≥ 0: this axis alone drives it
    int joint;  // ≥ 0: a nonlinear actuator, even only where positions are those of the actuators
    double steps;
    double count(const Move& m, bool joints) {
      double way = 0;
      if (joint >= 0)
        way = joints ? m.p1[joint] - m.p0[joint] : 0;
      else if (axis < 0)
        for (int j = 0; j < 3; ++j) way += c[j] * (m.p1[j] - m.p0[j]);
      else if (axis != kE || m.extruder == spec->index)
        way = m.p1[axis] - m.p0[axis];
      return steps = std::fabs(way) * spec->steps_per_unit;
    }
  };

  const Machine& machine_;
  std::vector<Motor> motors_;
  Budget budget_;
  double own_tolerance_, widest_, saving_;  // saving: commands at own / commands at widest
  LimitId limit_;
  int curved_motors_ = 0;
  double reach2_ = 0;  // speed² that the move before reaches at most
  double ahead_ = 0;   // commands beyond the rate

  void spend(Move& m, Soonest& soonest, double start2) {
    double of_ramp = kPerRampSecond * soonest.ramp_s * std::sqrt(m.a / m.d);
    double commands = 0;
    auto add = [&](double steps, int motors, double of_bends = 0) {
      double least = kPerMove * motors + of_bends;
      commands +=
          steps <= least ? steps : std::min(steps, least + of_ramp * std::sqrt(steps * motors));
    };
    if (curved_motors_ > 0)
      add(m.curved_steps, curved_motors_, kPerBendSecond * m.curved_bends * m.d);
    for (const Motor& motor : motors_) add(motor.steps, 1);
    const double of_steps = commands, of_outputs = m.records;  // one each, about as long
    commands += of_outputs;
    m.commands = commands;
    double room = budget_.burst - ahead_;
    double allowed = budget_.command_rate * soonest.seconds + room;
    if (!(commands > allowed)) {  // also where no actuator position exists, and so no number
      ahead_ = std::max(0.0, ahead_ + commands - budget_.command_rate * soonest.seconds);
      return;
    }
    ahead_ = budget_.burst;
    m.command_load = commands / allowed;
    const double needed = of_steps / std::max(allowed - of_outputs, 1e-9);
    m.commands = of_steps / std::min(needed, saving_) + of_outputs;
    if (needed <= saving_) {
      double square = needed * needed;
      m.tolerance = std::min(own_tolerance_ * square * square, widest_);
      return;
    }
    m.tolerance = widest_;
    double over =
        of_steps / saving_ + of_outputs - room;  // above command_rate × seconds, so never 0
    double speed = m.d * budget_.command_rate / over;
    m.vn2 = std::min(m.vn2, speed * speed);
    m.speed_limit = limit_;
    soonest = Soonest(m, std::min(start2, m.vn2));
  }
};

}  // namespace passo
