#include "plan/budget.hpp"

namespace passo {

template <class Fits>
double MoveBudget::largest(double most, Fits fits) {
  double least = 0;
  for (int i = 0; i < 30; ++i) {
    double half = 0.5 * (least + most);
    (fits(half) ? least : most) = half;
  }
  return most;
}

MoveBudget::MoveBudget(const Machine& machine)
    : machine_(machine), budget_(machine.budget), own_tolerance_(machine.tolerance),
      widest_(machine.widest_tolerance()), saving_(std::sqrt(std::sqrt(widest_ / own_tolerance_))),
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

void MoveBudget::use_geometry() {
  for (Motor& motor : motors_)
    if (motor.spec->drive == Drive::actuator) machine_.geometry->linear(motor.spec->index, motor.c);
}

void MoveBudget::restart(double start2) {
  reach2_ = start2;
  last_per_s_ = 0;
  for (Motor& motor : motors_) motor.slope = 0;
}

void MoveBudget::rest(double seconds) {
  if (budget_.command_rate < kInfinity)
    ahead_ = std::max(0.0, ahead_ - budget_.command_rate * seconds);
}

void MoveBudget::apply(Move& m, double start2) {
  m.ahead0 = ahead_;
  charge(m, start2);
  m.ahead1 = ahead_;
}

inline void MoveBudget::charge(Move& m, double start2) {
  if (m.kind == MoveKind::dwell) {
    settle(0);
    restart(0);
    rest(m.duration);
    return;
  }
  double steps = m.curved_steps;
  for (Motor& motor : motors_) steps += motor.count(m, machine_.joints);
  // Of the motors together: they may take up the gaps of their drives.
  const double every[] = {1, 1, 1};
  steps *= 1 + machine_.filters.share(every);
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

inline MoveBudget::Asked MoveBudget::ask(const Move& m, const Shape& s, double saving) const {
  Asked sum{double(m.records)};  // one each, about as long
  const double more = machine_.filters.on() ? kFiltered : 1;
  for (const Need& need : needs_) {
    double least = std::min(kMaxPerTurn, need.turn / saving) + kPerSecond * s.seconds;
    double own = need.motors * least + (need.bends + need.per_ramp_s * s.ramp_s) / saving;
    own *= more;
    if (own < need.steps) sum.per_ramp_s += more * need.per_ramp_s / saving;
    double brake = budget_.commits * s.seconds * (need.motors + need.brake * s.peak);
    sum.commands += std::min(own, need.steps) + std::min(brake, need.steps);
  }
  return sum;
}

inline void MoveBudget::list_needs(const Move& m) {
  needs_.clear();
  double of_path = std::sqrt(m.a / m.d);
  auto add = [&](double steps, int motors, double turn, double bends) {
    if (steps <= 0) return;
    double root = of_path * std::sqrt(steps * motors);
    double per_ramp_s = kPerRampSecond * root, brake = kPerBrake * root / m.a;
    needs_.push_back({steps, double(motors), turn, bends, per_ramp_s, brake});
  };
  if (curved_motors_ > 0)
    add(m.curved_steps, curved_motors_, kMaxPerTurn * saving_,
        kPerBendSecond * m.curved_bends * m.d);
  for (const Motor& motor : motors_) add(motor.steps, 1, kPerTurn * std::sqrt(motor.turn), 0);
}

inline void MoveBudget::settle(double end2) {
  if (last_per_s_ == 0 || end2 == last_.end2) return;
  Shape is = last_;
  is.end2 = end2;
  is.time();
  double longer = is.seconds - last_.seconds;
  ahead_ += last_per_s_ * (is.ramp_s - last_.ramp_s) - budget_.command_rate * longer;
  ahead_ = std::max(0.0, ahead_);
}

inline void MoveBudget::spend(Move& m, double start2) {
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

}  // namespace passo
