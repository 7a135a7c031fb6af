#include "plan/bounds.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "geometry/line_sampling.hpp"

namespace passo {

bool Bounds::apply(Move& m, const Rules& rules) const {
  const Limits& limits = rules.limits;
  const Constraints& constraints = *rules.constraints;
  const double speed_factor = m.unscaled ? 1 : rules.speed_factor;
  m.curved_steps = m.curved_bends = m.tolerance = m.step_load = m.command_load = 0;
  m.ahead0 = m.ahead1 = 0;
  for (size_t i = 0; i < kBudgets; ++i) m.steps[i] = m.commands[i] = 0;
  m.step_budget = m.command_budget = 0;
  if (m.kind == MoveKind::dwell) {
    m.d = m.vn2 = 0;
    m.a = m.b = m.cruise_a = 1;
    m.cartesian = false;
    m.speed_limit = m.accel_limit = kDuration;
    return m.duration > 0;
  }
  double delta[kAxes], mm = 0, longest = 0;
  for (int j = 0; j < kAxes; ++j) {
    delta[j] = m.p1[j] - m.p0[j];
    longest = std::max(longest, std::fabs(delta[j]));
    if (j < 3) mm += delta[j] * delta[j];
  }
  if (longest < kNoDistance) return false;
  // If X, Y and Z move very little, their distance cannot measure the path of a much longer axis.
  double least = std::max(kNoDistance, kMinPathShare * longest);
  m.cartesian = mm > least * least;
  mm = m.cartesian ? std::sqrt(mm) : longest;
  m.d = mm;
  double per_mm = 1;  // path measure per mm
  if (limits.junction == JunctionLaw::cornering_distance) {
    m.d = 0;
    for (int j = 0; j < kAxes; ++j) m.d = std::max(m.d, junction_.steps(m, j));
    per_mm = m.d / mm;
  }
  LimitId accel_id = m.kind == MoveKind::print     ? kPrintAccel
                     : m.kind == MoveKind::extrude ? kRetractAccel
                                                   : kTravelAccel;
  double v = std::min(m.feed * speed_factor, 1e6) * per_mm;
  LimitId speed_id = kFeedrate;
  if (m.duration > 0 && m.d < v * m.duration / speed_factor)
    v = m.d * speed_factor / m.duration, speed_id = kDuration;
  if (m.fastest > 0 && v > m.fastest * per_mm) v = m.fastest * per_mm, speed_id = kLaserPower;
  if (m.cartesian && v > limits.speed * per_mm) v = limits.speed * per_mm, speed_id = kPathSpeed;
  const double set = std::min(accel_id == kPrintAccel     ? limits.print_accel
                              : accel_id == kRetractAccel ? limits.retract_accel
                                                          : limits.travel_accel,
                              kMaxAccel);
  double a = set * per_mm;
  // The extruder alone has no acceleration of its own here, as in Klipper.
  const double of_path = accel_id == kRetractAccel ? std::min(limits.print_accel, kMaxAccel) : set;
  m.cruise_a = of_path * per_mm * (1 - limits.minimum_cruise_ratio);
  double inverse = 1 / m.d;
  const Bed bed = bed_below(m);
  // `bend`: second derivative of the row's position by path length.
  auto tighten = [&](const Row& row, double distance, double bend = 0) {
    double part = std::fabs(distance) * inverse;
    if (part * v > row.speed) v = row.speed / part, speed_id = row.speed_id;
    if (bend * v * v > kOfBends * row.accel)
      v = std::sqrt(kOfBends * row.accel / bend), speed_id = row.accel_id;
    double left = row.accel - bend * v * v;
    if (part * a > left) a = left / part, accel_id = row.accel_id;
  };
  for (size_t i = 0; machine_.joints && i < constraints.actuators.size(); ++i)
    tighten(constraints.actuators[i], delta[i]);
  double c[3];
  for (const Row& row : constraints.rows) {
    if (machine_.joints && row.axis < 3 && !machine_.geometry->linear(row.axis, c)) continue;
    double distance = row.axis >= 0
                          ? delta[row.axis]
                          : row.c[0] * delta[0] + row.c[1] * delta[1] + row.c[2] * delta[2];
    if (row.axis < 0 && machine_.filters.differ()) {
      distance = 0;  // the axes reach their highest speeds at different times
      for (int j = 0; j < 3; ++j) distance += std::fabs(row.c[j] * delta[j]);
    }
    double lift = std::fabs(row.c[kZ]);
    const double share = machine_.filters.share(row.c);  // additional speed that takes up a gap
    const double part = std::fabs(distance) * inverse;
    tighten(row, (std::fabs(distance) + lift * bed.slope * m.d) * (1 + share), lift * bed.bend);
    if (share * part * v > row.jerk) v = row.jerk / (share * part), speed_id = kBacklash;
  }
  if (delta[kE] != 0) tighten(constraints.extruders[m.extruder], delta[kE]);
  if (m.advance > 0 && machine_.filters.advances(m.extruder)) {
    // Smoothed by a triangle of half width h, the advance adds A a to the filament's speed, and
    // A a / h to its acceleration, at most. Half of the speed is left for the speed itself.
    const Row& row = constraints.extruders[m.extruder];
    const double part = std::fabs(delta[kE]) * inverse,
                 h = machine_.filters.advance.half_s[m.extruder];
    const double hardest =
        std::min(row.accel / (part * (1 + m.advance / h)), 0.5 * row.speed / (part * m.advance));
    if (a > hardest) a = hardest, accel_id = kAdvance;
    const double fastest = row.speed / part - m.advance * a;
    if (v > fastest) v = fastest, speed_id = kAdvance;
  }
  if (m.radius < kInfinity) {
    if (v * v > a * m.radius * per_mm) v = std::sqrt(a * m.radius * per_mm), speed_id = kArc;
    const Turn turn = turn_of(m);
    for (const Row& row : constraints.rows) {
      const double* c = row.c;
      double part = std::fabs(c[0] * turn.to[0] + c[1] * turn.to[1] + c[2] * turn.to[2]);
      double bend = part * turn.bend;
      if (bend * v * v > row.accel) v = std::sqrt(row.accel / bend), speed_id = kArc;
    }
  }
  m.vn2 = v * v;
  m.a = m.b = a;
  m.deviation = JunctionRule::deviation(limits, set);
  m.speed_limit = speed_id;
  m.accel_limit = accel_id;
  return true;
}

void Bounds::split(const Move& m, const Rules& rules, std::vector<Move>& parts) {
  parts.clear();
  double mm2 = 0;
  for (int j = 0; j < 3; ++j) mm2 += (m.p1[j] - m.p0[j]) * (m.p1[j] - m.p0[j]);
  choose_points(m, std::sqrt(mm2));
  samples_.resize(points_.size());
  for (size_t i = 0; i < points_.size(); ++i)
    samples_[i] = sample(m, *rules.constraints, points_[i].s);
  size_t first = 0, end = samples_.size() - 1;
  while (first < end) {
    Sample part = worse(samples_[first], samples_[first + 1]);
    double fastest = part.v, hardest = part.a;
    size_t last = first + 1;
    while (last < end) {
      Sample next = worse(part, samples_[last + 1]);
      Sample here = worse(samples_[last], samples_[last + 1]);
      fastest = std::max(fastest, here.v);
      hardest = std::max(hardest, here.a);
      if (next.v < kAlike * fastest || next.a < kAlike * hardest) break;
      part = next;
      ++last;
    }
    parts.push_back(m);
    Move& p = parts.back();
    cut(m, points_[first].fraction, points_[last].fraction, p);
    p.inner = m.inner || first > 0;
    if (part.v * part.v < p.vn2) p.vn2 = part.v * part.v, p.speed_limit = part.speed_id;
    if (part.a < p.a) p.a = p.b = part.a, p.accel_limit = part.accel_id;
    p.curved_steps = part.steps * p.d;
    p.curved_bends = part.bends;
    first = last;
  }
}

void Bounds::cut(const Move& m, double from, double to, Move& part) {
  part.d = m.d * (to - from);
  part.duration = m.duration * (to - from);
  if (from > 0 && m.flow > 0) part.owed = owed_after(m.owed, (m.p1[kE] - m.p0[kE]) * from);
  for (int j = 0; j < kAxes; ++j) {
    if (from > 0) part.p0[j] = m.p0[j] + (m.p1[j] - m.p0[j]) * from;
    if (to < 1) part.p1[j] = m.p0[j] + (m.p1[j] - m.p0[j]) * to;
  }
}

void Bounds::choose_points(const Move& m, double mm) {
  int n = std::clamp(int(std::ceil(mm / kSampleEvery)), 1, kMaxSamples);
  const Sampling sampling(*machine_.geometry, m.p0, m.p1, mm, n);
  points_.assign(1, {0, 0});
  for (int i = 1; i <= n; ++i) {
    sampling.before(i, [&](double fraction) {
      points_.push_back({fraction, m.d * fraction});
      return true;
    });
    points_.push_back({double(i) / n, m.d * i / n});
  }
}

Bounds::Sample Bounds::worse(const Sample& x, const Sample& y) {
  return {std::min(x.v, y.v),
          std::min(x.a, y.a),
          std::max(x.steps, y.steps),
          std::max(x.bends, y.bends),
          x.v < y.v ? x.speed_id : y.speed_id,
          x.a < y.a ? x.accel_id : y.accel_id};
}

Bounds::Turn Bounds::turn_of(const Move& m) {
  Turn turn;
  if (!(m.radius < kInfinity)) return turn;
  const int u = (m.arc_axis + 1) % 3, v = (m.arc_axis + 2) % 3;
  double du = m.p1[u] - m.p0[u], dv = m.p1[v] - m.p0[v], way2 = du * du + dv * dv;
  if (!(way2 > 0)) return turn;
  double length = std::sqrt(way2);
  turn.to[u] = -dv / length;
  turn.to[v] = du / length;
  turn.bend = way2 / (m.d * m.d * m.radius);
  return turn;
}

Bounds::Bed Bounds::bed_below(const Move& m) const {
  if (!machine_.height_map || machine_.joints) return {};
  const HeightMap& map = *machine_.height_map;
  const Fade& fade = map.fade();
  double x = (m.p1[0] - m.p0[0]) / m.d, y = (m.p1[1] - m.p0[1]) / m.d;
  double low = std::min(m.p0[kZ], m.p1[kZ]), high = std::max(m.p0[kZ], m.p1[kZ]);
  double factor = fade.around(low).at(low), tilt = map.steepest() * std::sqrt(x * x + y * y);
  Bed bed{factor * tilt, factor * (2 * map.twist() * std::fabs(x * y))};
  if (low < fade.end && high > fade.start) {
    double by_path = (m.p1[kZ] - m.p0[kZ]) / m.d / (fade.end - fade.start);  // of the factor
    bed.slope += std::fabs(by_path) * map.range();
    bed.bend += 2 * std::fabs(by_path) * tilt;
  }
  return bed;
}

void Bounds::slopes_above(const Bed& bed, int i, const Path& path, double s, double& q1,
                          double& q2) const {
  double first[3], second[3], at[3];
  for (int j = 0; j < 3; ++j) at[j] = path.p0[j] + (path.p1[j] - path.p0[j]) / path.length * s;
  double lift = machine_.raised(at) - at[kZ];
  for (int side = -1; side <= 1; ++side) {
    Path line = path;
    double tilt = side * bed.slope;
    line.p0[kZ] += lift - tilt * s;
    line.p1[kZ] += lift + tilt * (path.length - s);
    machine_.geometry->slopes(i, line, s, first[side + 1], second[side + 1]);
  }
  Path up = {{at[0], at[1], at[2] + lift}, {at[0], at[1], at[2] + lift + 1}, 1};
  double lifts, curved;
  machine_.geometry->slopes(i, up, 0, lifts, curved);
  q1 = std::max(std::fabs(first[0]), std::fabs(first[2]));
  q2 = std::fabs(second[1]) + 0.5 * std::fabs(second[2] - second[0]) +
       0.5 * std::fabs(second[2] + second[0] - 2 * second[1]) + std::fabs(lifts) * bed.bend;
}

Bounds::Sample Bounds::sample(const Move& m, const Constraints& constraints, double s) const {
  Path path;
  std::memcpy(path.p0, m.p0, sizeof path.p0);
  std::memcpy(path.p1, m.p1, sizeof path.p1);
  path.length = m.d;
  double v = std::sqrt(m.vn2), a = m.a;
  LimitId speed_id = m.speed_limit, accel_id = m.accel_limit;
  constexpr int kMost = Geometry::kMostActuators;
  double q1[kMost], q2[kMost], line2[kMost];  // the last without an arc's own bend
  const int n = machine_.geometry->actuators();
  const Bed bed = bed_below(m);
  const Turn turn = turn_of(m);
  Path inwards{{}, {}, 1};
  for (int j = 0; turn.bend > 0 && j < 3; ++j) {
    inwards.p0[j] = path.p0[j] + (path.p1[j] - path.p0[j]) * (s / m.d);
    inwards.p1[j] = inwards.p0[j] + turn.to[j];
  }
  for (int i = 0; i < n; ++i) {
    if (machine_.height_map)
      slopes_above(bed, i, path, s, q1[i], q2[i]);
    else
      machine_.geometry->slopes(i, path, s, q1[i], q2[i]);
    q1[i] = std::fabs(q1[i]);
    line2[i] = q2[i] = std::fabs(q2[i]);
    if (turn.bend > 0) {
      double first, second;
      machine_.geometry->slopes(i, inwards, 0, first, second);
      q2[i] += std::fabs(first) * turn.bend;
    }
    const Row& row = constraints.actuators[size_t(i)];
    if (q1[i] * v > row.speed) v = row.speed / q1[i], speed_id = row.speed_id;
    if (q2[i] * v * v > kOfBends * row.accel)
      v = std::sqrt(kOfBends * row.accel / q2[i]), speed_id = row.accel_id;
  }
  for (int i = 0; i < n; ++i) {
    const Row& row = constraints.actuators[size_t(i)];
    double left = row.accel - q2[i] * v * v;
    if (q1[i] * a > left) a = left / q1[i], accel_id = row.accel_id;
  }
  double steps = 0, bends = 0;
  for (const StepperSpec& s : machine_.steppers)
    if (s.drive == Drive::actuator && s.index < n) {
      steps += q1[s.index] * s.steps_per_unit;
      bends += std::sqrt(line2[s.index] * s.steps_per_unit);
    }
  return {v, a, steps, bends, speed_id, accel_id};
}

}  // namespace passo
