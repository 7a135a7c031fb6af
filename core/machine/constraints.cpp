#include "machine/constraints.hpp"

#include <algorithm>
#include <cmath>

namespace passo {

void Constraints::set(const Machine& m, const std::string& axis, double Row::* limit,
                      double value) {
  Constraints own(m);
  auto apply = [&](std::vector<Row>& mine, const std::vector<Row>& original, size_t i) {
    mine[i].*limit = std::min(value, original[i].*limit);
  };
  for (size_t i = 0; i < m.axes.size(); ++i)
    if (m.axes[i].name == axis) apply(rows, own.rows, i);
  for (size_t i = 0; i < m.extruders.size(); ++i)
    if (m.extruders[i].name == axis) apply(extruders, own.extruders, i);
}

Constraints Constraints::rescaled(const Constraints& before, const Machine& m) const {
  Constraints now(m);
  auto lower = [](std::vector<Row>& now, const std::vector<Row>& set, const std::vector<Row>& own) {
    for (size_t i = 0; i < std::min(set.size(), now.size()); ++i)
      for (double Row::* limit : {&Row::speed, &Row::accel, &Row::jerk})
        if (set[i].*limit < (1 - kRounded) * own[i].*limit)
          now[i].*limit = std::min(now[i].*limit, set[i].*limit);
  };
  lower(now.rows, rows, before.rows);
  lower(now.extruders, extruders, before.extruders);
  return now;
}

Constraints::Constraints(const Machine& m) {
  for (const StepperSpec& s : m.steppers)
    checks_reach_ |= s.drive == Drive::actuator && (s.min > -kInfinity || s.max < kInfinity);
  for (size_t i = 0; i < m.axes.size(); ++i)
    rows.push_back(single(slot_of_axis(int(i)), m.axes[i]));
  for (const Extruder& e : m.extruders) extruders.push_back(single(kE, e));
  bool linear = true;
  double c[3];
  for (int i = 0; i < m.geometry->actuators(); ++i) linear = linear && m.geometry->linear(i, c);
  checks_reach_ |= !linear;
  if (!linear) {
    for (int i = 0; i < m.geometry->actuators(); ++i)
      actuators.push_back(Row{{}, -1, kInfinity, kInfinity, 0, 0});
  }
  for (const StepperSpec& s : m.steppers) add_stepper(m, s, linear);
}

LimitId Constraints::add_name(const std::string& name) {
  names.push_back(name);
  return LimitId(names.size() - 1);
}

void Constraints::tighten(Row& row, const StepperSpec& s, double share) {
  double rate = share * s.max_rate / s.steps_per_unit;
  if (s.speed < row.speed && s.speed <= rate) {
    row.speed = s.speed;
    row.speed_id = add_name("stepper " + s.name + " speed");
  } else if (rate < row.speed) {
    row.speed = rate;
    row.speed_id = add_name("stepper " + s.name + " step rate");
  }
  if (s.accel < row.accel) {
    row.accel = s.accel;
    row.accel_id = add_name("stepper " + s.name + " acceleration");
  }
}

void Constraints::add_stepper(const Machine& m, const StepperSpec& s, bool linear) {
  if (s.drive == Drive::extruder) return tighten(extruders[size_t(s.index)], s);
  if (s.drive == Drive::axis) return tighten(rows[size_t(s.index)], s);
  // Lines are sampled. Between the samples a motor may be up to 1 % faster.
  if (!linear) return tighten(actuators[size_t(s.index)], s, 0.99);
  double c[3];
  m.geometry->linear(s.index, c);
  for (int axis = 0; axis < 3; ++axis)
    if (std::fabs(c[axis]) == 1 && std::fabs(c[0]) + std::fabs(c[1]) + std::fabs(c[2]) == 1)
      return tighten(rows[size_t(axis)], s);
  Row row{{c[0], c[1], c[2]}, -1, kInfinity, kInfinity, 0, 0};
  tighten(row, s);
  rows.push_back(row);
}

}  // namespace passo
