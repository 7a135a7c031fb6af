#include "motion/reach.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "geometry/line_sampling.hpp"

namespace passo {

bool Reach::reaches_arc(const MoveRequest& m, const double* from) {
  const Arc& arc = interpreter_.arc();
  if (m.radius_mm < kInfinity && arc.reached()) return true;
  if (!reaches_line(from, m.target, m.line)) return false;
  if (interpreter_.clamp || !arc.active()) return true;
  double start[kAxes], end[kAxes];
  std::copy_n(m.target, kAxes, start);
  for (Arc rest = arc; rest.active(); std::copy_n(end, kAxes, start)) {
    interpreter_.take_chord(rest, end);
    if (!reaches_line(start, end, m.line)) return false;
  }
  interpreter_.note_arc_reached();
  return true;
}

bool Reach::reaches_without_hop(MoveRequest& m, const double* from) {
  if (m.hop_mm <= 0) return false;
  const double mm = std::exchange(m.hop_mm, 0);
  m.target[kZ] -= mm;
  interpreter_.drop_hop(mm);
  return reaches_arc(m, from);
}

bool Reach::in_range(const MoveRequest& m) {
  for (int j = 0; j < kAxes; ++j)
    if ((m.moved >> j & 1) && !interpreter_.in_range(j, m.target[j], error_)) return false;
  return true;
}

bool Reach::reaches_shifted(const double* position, int j) {
  return interpreter_.in_range(j, position[j], error_) && (!checks() || reaches_point(position, 0));
}

bool Reach::reaches_line(const double* from, const double* to, uint32_t line) {
  const Geometry& geometry = *machine_.geometry;
  double mm = 0, p[3];
  for (int j = 0; j < 3; ++j) mm += (to[j] - from[j]) * (to[j] - from[j]);
  mm = std::sqrt(mm);
  int n = std::min(1 + int(mm / kCheckEvery), 4096);
  const Sampling sampling(geometry, from, to, mm, n);
  auto reaches = [&](double at) {
    for (int j = 0; j < 3; ++j) p[j] = from[j] + (to[j] - from[j]) * at;
    return reaches_point(p, line, from);
  };
  for (int i = 1; i <= n; ++i) {
    if (!sampling.before(i, reaches)) return false;
    for (int j = 0; j < 3; ++j) p[j] = i == n ? to[j] : from[j] + (to[j] - from[j]) * i / n;
    if (!reaches_point(p, line, from)) return false;
  }
  return !geometry.jumps(from, to) || stop_at_jump(from, to, line);
}

bool Reach::stop_at_jump(const double* from, const double* to, uint32_t line) {
  double low = 0, high = 1, p[3];
  for (int k = 0; k < 48; ++k) {
    double middle = 0.5 * (low + high);
    for (int j = 0; j < 3; ++j) p[j] = from[j] + (to[j] - from[j]) * middle;
    (machine_.geometry->jumps(from, p) ? high : low) = middle;
  }
  error_ = {line, Fault::unreachable, "", 0, 0, {p[0], p[1], p[2]}};
  return false;
}

bool Reach::reaches_point(const double* p, uint32_t line, const double* from) {
  for (const StepperSpec& s : machine_.steppers) {
    if (s.drive != Drive::actuator) continue;
    double q = machine_.geometry->inverse(s.index, p);
    double half_step = 0.5 / s.steps_per_unit;  // the nearest step may be this far outside
    if (q >= s.min - half_step && q <= s.max + half_step) continue;
    double start = from == nullptr ? q : machine_.geometry->inverse(s.index, from);
    if (q < s.min ? q > start : q < start) continue;
    double home = machine_.geometry->inverse(s.index, interpreter_.homed());
    if (q < s.min ? q >= home - half_step : q <= home + half_step) continue;
    bool unreachable = !(std::fabs(q) < 1e12);
    error_ = {line,
              unreachable ? Fault::unreachable : Fault::actuator,
              unreachable ? "" : s.name,
              unreachable ? 0 : q,
              q < s.min ? s.min : s.max,
              {p[0], p[1], p[2]}};
    return false;
  }
  return true;
}

}  // namespace passo
