// What a board's processor and its link can take, as limits of moves. Everything here follows from
// the moves in their order; nothing comes back from the compressor.
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
// times, which saves commands, and if that is not enough it gets slower. A move is taken to end as
// fast as it begins; what it needs more or less than that is known, and accounted for, with the
// next.
class MoveBudget {
 public:
  // Commands of a motor for a move: in each second of it so many, in each second of acceleration
  // the root of that in steps/s² times the second figure, and for the turn at its beginning the
  // root of the steps that this makes in the move times the third, but not more than the fourth;
  // and never more in all than its steps. Fitted to circles and random paths of 0.02 to 3 mm a
  // move, 5 to 300 mm/s, 1000 to 20000 mm/s², at 2 µs; at 25 µs what grows with a root is half.
  static constexpr double kPerSecond = 20, kPerRampSecond = 1.1, kPerTurn = 3, kMostPerTurn = 1.5;
  // The same where a nonlinear actuator accelerates along a straight line at constant speed. A
  // rotary delta's lines of 24 mm need that much, a delta's of 60 mm 0.7.
  static constexpr double kPerBendSecond = 0.9;
  // With each commit comes the way on which a motor that moves would brake: a command, and for the
  // root of its steps/mm by the acceleration, times the speed, so many. Nine were measured with two
  // motors at 60 mm/s, 22 with one at 250 mm/s, and 33 on a delta.
  static constexpr double kPerBrake = 0.5;

  explicit MoveBudget(const Machine& machine)
      : machine_(machine), budget_(machine.budget), own_tolerance_(machine.tolerance),
        widest_(machine.widest_tolerance()),
        saving_(std::sqrt(std::sqrt(widest_ / own_tolerance_))),
        limit_(machine.budget.by_link ? kLink : kBoard) {
    for (const StepperSpec& s : machine.steppers) {
      Motor motor{&s, {}, -1, -1};
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
  void restart(double start2) {
    reach2_ = start2;
    last_per_s_ = 0;
    for (Motor& motor : motors_) motor.slope = 0;
  }
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
      settle(0);
      restart(0);
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
    start2 = std::min(start2, reach2_);
    if (budget_.command_rate < kInfinity) spend(m, start2);
    start2 = std::min(start2, m.vn2);
    reach2_ = std::min(m.vn2, start2 + 2 * m.a * m.d);
  }

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
    const StepperSpec* spec;  // its scale may change while the machine stands
    double c[3];
    int axis;   // ≥ 0: this axis alone drives it
    int joint;  // ≥ 0: a nonlinear actuator, even only where positions are those of the actuators
    double steps = 0, turn = 0;  // turn: steps beyond what the slope of the move before would be
    double slope = 0;            // steps/mm
    double count(const Move& m, bool joints) {
      double way = 0;
      if (joint >= 0)
        way = joints ? m.p1[joint] - m.p0[joint] : 0;
      else if (axis < 0)
        for (int j = 0; j < 3; ++j) way += c[j] * (m.p1[j] - m.p0[j]);
      else if (axis != kE || m.extruder == spec->index)
        way = m.p1[axis] - m.p0[axis];
      double signed_steps = way * spec->steps_per_unit, was = slope;
      slope = signed_steps / m.d;
      turn = std::fabs(signed_steps - was * m.d);
      return steps = std::fabs(signed_steps);
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
  Asked ask(const Move& m, const Shape& s, double saving) const {
    Asked sum{double(m.records)};  // one each, about as long
    for (const Need& need : needs_) {
      double least = std::min(kMostPerTurn, need.turn / saving) + kPerSecond * s.seconds;
      double own = need.motors * least + (need.bends + need.per_ramp_s * s.ramp_s) / saving;
      if (own < need.steps) sum.per_ramp_s += need.per_ramp_s / saving;
      double brake = budget_.commits * s.seconds * (need.motors + need.brake * s.peak);
      sum.commands += std::min(own, need.steps) + std::min(brake, need.steps);
    }
    return sum;
  }
  void list_needs(const Move& m) {
    needs_.clear();
    double of_path = std::sqrt(m.a / m.d);
    auto add = [&](double steps, int motors, double turn, double bends) {
      if (steps <= 0) return;
      double root = of_path * std::sqrt(steps * motors);
      double per_ramp_s = kPerRampSecond * root, brake = kPerBrake * root / m.a;
      needs_.push_back({steps, double(motors), turn, bends, per_ramp_s, brake});
    };
    if (curved_motors_ > 0)
      add(m.curved_steps, curved_motors_, kMostPerTurn * saving_,
          kPerBendSecond * m.curved_bends * m.d);
    for (const Motor& motor : motors_) add(motor.steps, 1, kPerTurn * std::sqrt(motor.turn), 0);
  }

  // The move before ends at that speed².
  void settle(double end2) {
    if (last_per_s_ == 0 || end2 == last_.end2) return;
    Shape is = last_;
    is.end2 = end2;
    is.time();
    double longer = is.seconds - last_.seconds;
    ahead_ += last_per_s_ * (is.ramp_s - last_.ramp_s) - budget_.command_rate * longer;
    ahead_ = std::max(0.0, ahead_);
  }

  // The largest at which `fits`, from 0 to `most`, and a thousand-millionth of that more.
  template <class Fits>
  static double largest(double most, Fits fits) {
    double least = 0;
    for (int i = 0; i < 30; ++i) {
      double half = 0.5 * (least + most);
      (fits(half) ? least : most) = half;
    }
    return most;
  }

  void spend(Move& m, double start2) {
    list_needs(m);
    Shape s(m, start2, m.vn2);
    Asked asked = ask(m, s, 1);
    double room = budget_.burst - ahead_;
    auto fits = [&](const Shape& shape, const Asked& of_it) {
      return of_it.commands <= budget_.command_rate * shape.seconds + room;
    };
    if (!fits(s, asked)) {
      double allowed = budget_.command_rate * s.seconds + std::max(0.0, room);
      m.command_load = asked.commands / allowed;
      double saving = saving_;
      asked = ask(m, s, saving);
      // Of what was spent too much before it a move makes up for no more than it needs itself.
      room = std::max(room, -asked.commands);
      if (!fits(s, asked)) {
        m.vn2 = largest(m.vn2, [&](double v2) {
          Shape slower(m, start2, v2);
          return fits(slower, ask(m, slower, saving));
        });
        m.speed_limit = limit_;
        s = Shape(m, start2, m.vn2);
      } else {
        saving = 1 / largest(1.0, [&](double part) { return fits(s, ask(m, s, 1 / part)); });
      }
      asked = ask(m, s, saving);
      double square = saving * saving;
      m.tolerance = std::min(own_tolerance_ * square * square, widest_);
    }
    settle(s.start2);
    m.commands = asked.commands;
    ahead_ = std::max(0.0, ahead_ + m.commands - budget_.command_rate * s.seconds);
    last_ = s;
    last_per_s_ = asked.per_ramp_s;
  }
};

}  // namespace passo
