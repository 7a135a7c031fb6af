#include "filters/nozzle_law.hpp"

namespace passo {

bool NozzleLaw::needed() const {
  return std::any_of(
      machine_.steppers.begin(), machine_.steppers.end(), [this](const StepperSpec& spec) {
        double c[3];
        if (spec.drive != Drive::actuator) return false;
        return !machine_.geometry->linear(spec.index, c) || (machine_.height_map && c[kZ] != 0);
      });
}

// Called at standstill, where filters may have changed.
void NozzleLaw::begin(const Move& m) {
  const Filters& filters = machine_.filters;
  track_.cubic = false;
  earliest_ = filters.delay(machine_.clock_hz);
  for (int i = 0; i < 3; ++i) {
    Law& law = laws_[i];
    law.follow_axis(filters, i);
    law.begin(m);
    track_.cubic |= law.parts() == PartKind::cubics;
    earliest_ = std::min(earliest_, law.earliest());
  }
  going_ = true;
}

void NozzleLaw::add(const Move& m, double until) {
  if (m.kind == MoveKind::dwell) {
    if (going_)
      for (Law& law : laws_) law.resume(std::min(m.end(), until));
    return;
  }
  if (!going_) {
    begin(m);
    start(m.start);
  }
  for (Law& law : laws_) law.add(m, until);
}

void NozzleLaw::start(double clock) {
  track_.reserve(0);
  track_.n = 0;
  track_.t[0] = clock;
  for (size_t i = 0; i < 3; ++i) {
    laws_[i].start(clock);
    track_.p[i][0] = axes_[i].q = laws_[i].q();
  }
  track_.finish();
}

void NozzleLaw::restart(double clock, const std::vector<Move>& past) {
  going_ = false;
  for (const Move& m : past) add(m, clock);
  if (!going_) return;
  for (Law& law : laws_) law.resume(clock);
  start(clock);
}

void NozzleLaw::solve(const std::vector<Move>& moves, double known, bool last) {
  // Continues at the end of the last track.
  if (going_ && track_.n > 0) {
    track_.t[0] = track_.t[track_.n];
    for (auto& p : track_.p) p[0] = p[track_.n];
    track_.n = 0;
  }
  for (const Move& m : moves) add(m, kNeverTicks);
  if (!going_) return;
  if (last)
    for (Law& law : laws_) law.stand();
  for (size_t i = 0; i < 3; ++i) laws_[i].advance(known + earliest_, last, axes_[i]);
  merge();
  going_ = !last;
}

// Merges the intervals of the three axes into one track, with the breakpoints of all of them.
void NozzleLaw::merge() {
  size_t most = 0, next[3] = {0, 0, 0};
  double at = track_.t[0], end = at, from[3] = {at, at, at};
  for (const Intervals& axis : axes_) {
    most += axis.all.size();
    if (!axis.all.empty()) end = std::max(end, axis.all.back().end);
  }
  track_.reserve(most);
  size_t n = 0;
  while (at < end) {
    double to = end;
    for (size_t i = 0; i < 3; ++i)
      if (next[i] < axes_[i].all.size()) to = std::min(to, axes_[i].all[next[i]].end);
    for (size_t i = 0; i < 3; ++i) {
      if (next[i] == axes_[i].all.size()) {
        track_.p[i][n] = axes_[i].q;
        track_.v0[i][n] = track_.v1[i][n] = 0;
        continue;
      }
      const Interval& axis = axes_[i].all[next[i]];
      const double u = at - from[i];
      const double w = to - from[i], bend = 0.5 * axis.j;  // 0 for a quadratic
      track_.p[i][n] = axis.q + u * (axis.v + (0.5 * axis.a * u + bend * (1.0 / 3) * u * u));
      track_.v0[i][n] = axis.v + (axis.a * u + bend * u * u);
      track_.v1[i][n] = axis.v + (axis.a * w + bend * w * w);
      if (axis.end <= to) from[i] = axis.end, ++next[i];
    }
    if (to > at) track_.t[++n] = to;
    at = to;
  }
  for (size_t i = 0; i < 3; ++i) {
    track_.p[i][n] = axes_[i].q;
    axes_[i].all.clear();
  }
  track_.n = n;
  track_.finish();
}

}  // namespace passo
