#include "plan/board_budget.hpp"

namespace passo {

template <class Fits>
double BoardBudget::largest(double most, Fits fits) {
  double least = 0;
  for (int i = 0; i < 30; ++i) {
    double half = 0.5 * (least + most);
    (fits(half) ? least : most) = half;
  }
  return most;
}

BoardBudget::BoardBudget(const Machine& machine, uint8_t index)
    : machine_(machine), budget_(machine.budgets[index]), index_(index),
      own_tolerance_(machine.tolerance), widest_(machine.widest_tolerance()),
      saving_(std::sqrt(std::sqrt(widest_ / own_tolerance_))),
      limit_(budget_.by_link ? kLink : kBoard) {
  for (const StepperSpec& s : machine.steppers) {
    if (s.budget != index) continue;
    Motor motor{&s, {}, -1, -1};
    if (s.drive != Drive::actuator)
      motor.axis = s.drive == Drive::axis ? slot_of_axis(s.index) : int(kE);
    else if (!machine.geometry->linear(s.index, motor.c))
      motor.joint = s.index, ++curved_motors_;
    motors_.push_back(motor);
  }
}

void BoardBudget::use_geometry() {
  for (Motor& motor : motors_)
    if (motor.spec->drive == Drive::actuator) machine_.geometry->linear(motor.spec->index, motor.c);
}

void BoardBudget::restart(double start2) {
  reach2_ = start2;
  last_per_s_ = 0;
  for (Motor& motor : motors_) motor.slope = 0;
}

void BoardBudget::rest(double seconds) {
  if (budget_.command_rate < kInfinity)
    ahead_ = std::max(0.0, ahead_ - budget_.command_rate * seconds);
}

void BoardBudget::dwell(double seconds) {
  settle(0);
  restart(0);
  rest(seconds);
}

void BoardBudget::bound_steps(Move& m) {
  double steps = curved_motors_ > 0 ? m.curved_steps : 0;
  for (Motor& motor : motors_) steps += motor.count(m, machine_.joints);
  // All motors together: they may take up the gaps of their drives.
  const double every[] = {1, 1, 1};
  steps *= 1 + machine_.filters.share(every);
  m.steps[index_] = float(steps);
  double most = budget_.step_rate * m.d;  // at this, speed × steps
  if (m.vn2 * steps * steps > most * most) {
    const double load = std::sqrt(m.vn2) * steps / most;
    if (load > m.step_load) m.step_load = load, m.step_budget = index_;
    m.vn2 = (most / steps) * (most / steps);
    m.speed_limit = kBoard;
  }
}

void BoardBudget::charge(Move& m, double start2) {
  start2 = std::min(start2, reach2_);
  if (budget_.command_rate < kInfinity) spend(m, start2);
  start2 = std::min(start2, m.vn2);
  reach2_ = std::min(m.vn2, start2 + 2 * m.a * m.d);
}

inline BoardBudget::Asked BoardBudget::ask(const Move& m, const Shape& s, double saving) const {
  Asked sum{double(m.records)};  // one each, about as long; every board counts all
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

inline void BoardBudget::list_needs(const Move& m) {
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

inline void BoardBudget::settle(double end2) {
  if (last_per_s_ == 0 || end2 == last_.end2) return;
  Shape is = last_;
  is.end2 = end2;
  is.time();
  double longer = is.seconds - last_.seconds;
  ahead_ += last_per_s_ * (is.ramp_s - last_.ramp_s) - budget_.command_rate * longer;
  ahead_ = std::max(0.0, ahead_);
}

inline void BoardBudget::spend(Move& m, double start2) {
  list_needs(m);
  Shape s(m, start2, m.vn2);
  Asked asked = ask(m, s, 1);
  double room = budget_.burst - ahead_;
  auto fits = [&](const Shape& shape, const Asked& of_it) {
    return of_it.commands <= budget_.command_rate * shape.seconds + room;
  };
  if (!fits(s, asked)) {
    double allowed = budget_.command_rate * s.seconds + std::max(0.0, room);
    const double load = asked.commands / allowed;
    if (load > m.command_load) m.command_load = load, m.command_budget = index_;
    double saving = saving_;
    asked = ask(m, s, saving);
    // A move saves at most its own need, however much the moves before it exceeded the budget.
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
    m.tolerance = std::max(m.tolerance, std::min(own_tolerance_ * square * square, widest_));
  }
  settle(s.start2);
  m.commands[index_] = float(asked.commands);
  ahead_ = std::max(0.0, ahead_ + asked.commands - budget_.command_rate * s.seconds);
  last_ = s;
  last_per_s_ = asked.per_ramp_s;
}

}  // namespace passo
