#include "plan/junction.hpp"

#include <algorithm>
#include <cmath>

namespace passo {

double JunctionRule::steps(const Move& m, int j) const {
  return std::fabs(m.p1[j] - m.p0[j]) * steps_per_mm(m, j);
}

double JunctionRule::cap2(const Move& before, const Move& m, const Rules& rules) const {
  const Limits& limits = rules.limits;
  const Constraints& own = *rules.constraints;
  double cap = std::min(before.vn2, m.vn2);
  if (before.kind == MoveKind::dwell || m.kind == MoveKind::dwell) return 0;
  if (m.inner) return before.flow == m.flow ? cap : std::min(cap, extruder_cap(before, m, own));
  if (limits.junction == JunctionLaw::cornering_distance) return cornering(before, m, cap);
  if (before.cartesian != m.cartesian) return 0;
  if (!m.cartesian) return alongside(before, m) ? cap : 0;
  if (limits.junction == JunctionLaw::jerk) return jerk(before, m, cap, own);
  return deviation(before, m, std::min(cap, extruder_cap(before, m, own)));
}

double JunctionRule::advance_cap2(const Move& before, const Move& m, const Rules& rules) const {
  if (before.kind == MoveKind::dwell || m.kind == MoveKind::dwell) return kInfinity;
  if (before.advance == 0 && m.advance == 0) return kInfinity;
  double cap = kInfinity;
  auto limit = [&](const Move* out, const Move* in, size_t extruder) {
    if (!machine_.filters.advances(extruder)) return;
    const double h = machine_.filters.advance.half_s[extruder];
    const Row& row = rules.constraints->extruders[extruder];
    double advanced[2] = {0, 0}, fastest = 0, added = 0;
    const Move* moves[2] = {out, in};
    for (int i = 0; i < 2; ++i) {
      if (!moves[i]) continue;
      const double part = std::fabs(unit(*moves[i], kE));
      advanced[i] = moves[i]->advance * part;
      fastest = std::max(fastest, part);
      added = std::max(added, advanced[i] * moves[i]->a);
    }
    const double change = std::fabs(advanced[1] - advanced[0]);
    if (!(change > 1e-12)) return;
    const double v =
        std::min((row.speed - added) / (fastest + change / h), row.accel * h * h / change);
    cap = std::min(cap, v > 0 ? v * v : 0);
  };
  if (before.extruder == m.extruder) {
    limit(&before, &m, m.extruder);
  } else {
    limit(&before, nullptr, before.extruder);
    limit(nullptr, &m, m.extruder);
  }
  return cap;
}

bool JunctionRule::alongside(const Move& before, const Move& m) const {
  if (before.extruder != m.extruder) return false;
  for (int j = kE; j < kAxes; ++j)
    if (std::fabs(unit(before, j) - unit(m, j)) > 1e-9) return false;
  return true;
}

double JunctionRule::extruder_cap(const Move& before, const Move& m, const Constraints& own) const {
  double cap = kInfinity;
  auto limit = [&cap](double change, double jerk) {
    if (change > 1e-12) cap = std::min(cap, (jerk / change) * (jerk / change));
  };
  double e0 = unit(before, kE), e1 = unit(m, kE);
  if (machine_.extruders.empty()) {
    // a laser or a mill
  } else if (before.extruder == m.extruder) {
    limit(std::fabs(e1 - e0), own.extruders[m.extruder].jerk);
  } else {
    limit(std::fabs(e0), own.extruders[before.extruder].jerk);
    limit(std::fabs(e1), own.extruders[m.extruder].jerk);
  }
  for (size_t i = 3; i < machine_.axes.size(); ++i) {
    int j = slot_of_axis(int(i));
    limit(std::fabs(unit(m, j) - unit(before, j)), own.rows[i].jerk);
  }
  return cap;
}

inline double JunctionRule::deviation(const Move& before, const Move& m, double cap) const {
  double inverse = 1 / (before.d * m.d);
  double cosine = -((m.p1[0] - m.p0[0]) * (before.p1[0] - before.p0[0]) +
                    (m.p1[1] - m.p0[1]) * (before.p1[1] - before.p0[1]) +
                    (m.p1[2] - m.p0[2]) * (before.p1[2] - before.p0[2])) *
                  inverse;
  double s = std::sqrt(std::max(0.0, 0.5 * (1 - cosine)));
  double c = std::sqrt(std::max(0.0, 0.5 * (1 + cosine)));
  const double reach = std::min(before.a * before.deviation, m.a * m.deviation);
  if (1 - s > 1e-12) cap = std::min(cap, reach * s / (1 - s));
  if (c > 1e-9) cap = std::min(cap, 0.5 * std::min(before.a * before.d, m.a * m.d) * s / c);
  return cap;
}

double JunctionRule::cornering(const Move& before, const Move& m, double cap) const {
  auto ratio = [this](const Move& x, int j) {
    return std::copysign(steps(x, j) / x.d, x.p1[j] - x.p0[j]);
  };
  auto limit = [&](int j, double change, double accel, double distance) {
    if (std::fabs(change) > 1e-12)
      cap = std::min(cap, accel * steps_per_mm(m, j) * distance / std::fabs(change));
  };
  for (size_t i = 0; i < machine_.axes.size(); ++i) {
    int j = slot_of_axis(int(i));
    limit(j, ratio(m, j) - ratio(before, j), machine_.axes[i].accel,
          machine_.axes[i].cornering_steps);
  }
  if (machine_.extruders.empty()) return cap;
  if (before.extruder != m.extruder) return 0;
  const Extruder& e = machine_.extruders[m.extruder];
  limit(kE, ratio(m, kE) - ratio(before, kE), e.accel, e.cornering_steps);
  return cap;
}

double JunctionRule::steps_per_mm(const Move& m, int j) const {
  for (const StepperSpec& s : machine_.steppers) {
    bool filament = s.drive == Drive::extruder && j == kE && s.index == m.extruder;
    bool axis = s.drive == Drive::axis && slot_of_axis(s.index) == j;
    bool actuator = s.drive == Drive::actuator && s.index < 3 && s.index == j;
    if (filament || axis || actuator) return s.steps_per_unit;
  }
  return 0;
}

double JunctionRule::jerk(const Move& before, const Move& m, double cap,
                          const Constraints& own) const {
  double v = std::sqrt(cap), factor = 1;
  auto limit = [&](double part0, double part1, double allowed) {  // of the path's speed
    double out = part0 * v, in = part1 * v;
    double change = out * in < 0 ? std::max(std::fabs(out), std::fabs(in)) : std::fabs(out - in);
    if (change * factor > allowed) factor = allowed / change;
  };
  for (size_t i = 0; i < machine_.axes.size(); ++i) {
    int j = slot_of_axis(int(i));
    limit(unit(before, j), unit(m, j), own.rows[i].jerk);
  }
  if (machine_.extruders.empty()) return cap * factor * factor;
  const double last = unit(before, kE), next = unit(m, kE);
  if (before.extruder == m.extruder) {
    limit(last, next, own.extruders[m.extruder].jerk);
  } else {
    limit(last, 0, own.extruders[before.extruder].jerk);
    limit(0, next, own.extruders[m.extruder].jerk);
  }
  return cap * factor * factor;
}

}  // namespace passo
