#include "filters/fastest_corner.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "filters/planned_laws.hpp"
#include "filters/smooth_law.hpp"

namespace passo {

namespace {

// X and Y of the cruise speed, mm/s.
std::array<double, 2> cruise(const Move* m) {
  if (!m || m->kind == MoveKind::dwell) return {0, 0};
  const double per = m->vc / m->d;
  return {(m->p1[kX] - m->p0[kX]) * per, (m->p1[kY] - m->p0[kY]) * per};
}

bool prints(const Move* m) { return m && m->kind == MoveKind::print && m->p1[kE] > m->p0[kE]; }

struct Nothing {
  void add(double, double, double, double, double) {}
  void cubic(double, double, double, double, double, double, double, double) {}
};

struct Parts {
  std::vector<FastestCorner::Part> all;
  double scale;
  void cubic(double t, double ticks, double q, double v, double a, double j, double, double) {
    all.push_back({t, ticks, q / scale, v / scale, a / scale, j / scale});
  }
};

}  // namespace

void FastestCorner::add(const Move& m, const std::function<int64_t(size_t)>& lead) {
  const Filters& filters = machine_.filters;
  const bool begins = recent_.empty() || m.start > recent_.back().end() + 0.5;
  if (open_ && (begins || !filters.on())) corner_->rests = true, open_ = false;
  if (!filters.on()) return recent_.clear();
  if (begins) begin(m, lead);
  const double needed = kLongestRamp * hz_ + margin(filters) + filters.memory(hz_);
  forget(m.start - needed);
  consider(recent_.empty() ? nullptr : &recent_.back(), m);
  recent_.push_back(m);
  if (!open_) return;
  corner_->moves.push_back(m);
  open_ = m.end() < corner_->clock + needed;
}

double FastestCorner::margin(const Filters& filters) const {
  return std::max(filters.memory(hz_), kLeastMargin * hz_);
}

const StepperSpec* FastestCorner::own_motor(int axis) const {
  for (const StepperSpec& s : machine_.steppers) {
    double c[3] = {0, 0, 0};
    if (s.drive != Drive::actuator || !machine_.geometry->linear(s.index, c)) continue;
    if (c[axis] != 0 && std::count(c, c + 3, 0.0) == 2) return &s;
  }
  return nullptr;
}

// Filters change only at standstill, so the gaps are set here.
void FastestCorner::begin(const Move& m, const std::function<int64_t(size_t)>& lead) {
  recent_.clear();
  for (int j = 0; j < 2; ++j) {
    Backlash& gap = gaps_[size_t(j)] = {};
    const StepperSpec* motor = own_motor(j);
    if (!motor) continue;
    const double steps = motor->steps_per_unit;
    const Gap& of = machine_.filters.gaps.of[motor->index];
    gap.set(of.mm * steps, of.over_mm * steps);
    gap.rest_with(double(lead(size_t(motor - machine_.steppers.data()))));
    gap.begin(m.start, m.p0[j] * steps);
  }
}

void FastestCorner::forget(double before) {
  for (; !recent_.empty() && recent_.front().end() <= before; recent_.pop_front()) {
    const Move& m = recent_.front();
    for (int j = 0; j < 2; ++j) {
      Backlash& gap = gaps_[size_t(j)];
      if (!gap.on() || m.kind == MoveKind::dwell) continue;
      const double steps = own_motor(j)->steps_per_unit, distance = m.p1[j] - m.p0[j];
      const double speed = distance > 0   ? 1
                           : distance < 0 ? -1
                                          : 0;  // the lead depends on the distance only
      Nothing nothing;
      gap.pass(m.end(), m.p1[j] * steps, speed, speed, 0, nothing);
      gap.forget(m.end());
    }
  }
}

void FastestCorner::consider(const Move* before, const Move& after) {
  const auto u = cruise(before), v = cruise(&after);
  const bool moves = (u[0] != 0 || u[1] != 0) && (v[0] != 0 || v[1] != 0);
  const int rank = prints(before) && prints(&after) ? 2 : moves ? 1 : 0;
  const double change = std::sqrt((v[0] - u[0]) * (v[0] - u[0]) + (v[1] - u[1]) * (v[1] - u[1]));
  if (corner_ ? !corner_->is_less(rank, change) : !(change > 0)) return;
  corner_.emplace();
  corner_->rank = rank;
  corner_->change = change;
  corner_->clock = after.start;
  corner_->at[0] = after.p0[kX], corner_->at[1] = after.p0[kY];
  corner_->line = after.line;
  corner_->extruder = after.extruder;
  corner_->filters = machine_.filters;
  corner_->moves.assign(recent_.begin(), recent_.end());
  corner_->gaps = gaps_;
  corner_->rests = false;
  open_ = true;
}

double FastestCorner::from() const {
  double ramp = 0;
  for (auto m = corner_->moves.rbegin(); m != corner_->moves.rend(); ++m) {
    if (m->start >= corner_->clock - 0.5) continue;
    ramp += m->t_dec;
    if (m->t_acc + m->t_cru > 0) break;
  }
  return clock() - std::min(ramp, kLongestRamp * hz_) - margin(corner_->filters);
}

double FastestCorner::to() const {
  double ramp = 0;
  for (const Move& m : corner_->moves) {
    if (m.start < corner_->clock - 0.5) continue;
    ramp += m.t_acc;
    if (m.t_cru + m.t_dec > 0) break;
  }
  return clock() + std::min(ramp, kLongestRamp * hz_) + margin(corner_->filters);
}

std::vector<FastestCorner::Part> FastestCorner::law(int slot, bool filtered) const {
  const Corner& c = *corner_;
  const StepperSpec* motor = slot < kZ ? own_motor(slot) : nullptr;
  const double scale = motor ? motor->steps_per_unit : 1, delay = c.filters.delay(hz_);
  PlannedLaws laws(hz_);
  laws.clear(c.filters);
  slot == kE ? laws.follow_extruder(c.extruder, scale) : laws.follow_axis(slot, scale);
  bool going = false;
  for (const Move& m : c.moves) {
    if (m.kind == MoveKind::dwell) {
      if (going) laws.resume(m.end());
      continue;
    }
    if (!going && laws.idles(m)) continue;
    if (!std::exchange(going, true)) laws.begin(m);
    laws.add(m, kNeverTicks);
  }
  if (!going) laws.begin(c.moves.front());
  const bool rests =
      c.rests || open_;  // open_: the print ended before the corner's moves were complete
  if (rests) laws.stand();
  SmoothLaw plain, full;
  for (size_t i = 0; i < laws.all().size(); ++i) {
    plain.add(&laws.all()[i], Kernel(), delay, hz_);
    full.add(&laws.all()[i], laws.kernel(i), delay, hz_);
  }
  SmoothLaw& law = filtered ? full : plain;
  Parts parts{{}, scale};
  double lead = 0;
  const double start = from(), end = to();
  const double limit = rests ? kAllTicks : c.moves.back().end() + law.earliest();
  if (filtered && slot < kZ && c.gaps[size_t(slot)].on()) {
    Backlash gap = c.gaps[size_t(slot)];
    const double begin = c.moves.front().start + delay;
    if (begin < start) {
      Nothing nothing;
      Backlash::Onto<Nothing> leading{gap, nothing};
      plain.start(begin);
      plain.advance(start, false, leading);
    }
    law.start(start);
    gap.resume(start, law.q(), Backlash(gap));
    Backlash::Onto<Parts> leading{gap, parts};
    law.advance(limit, rests, leading);
    lead = gap.lead();
  } else {
    law.start(start);
    law.advance(limit, rests, parts);
  }
  auto& all = parts.all;
  while (!all.empty() && all.back().start >= end) all.pop_back();
  const double known = all.empty() ? start : all.back().start + all.back().ticks;
  if (known >= end)
    all.back().ticks = end - all.back().start;
  else
    all.push_back({known, end - known, (law.q() + lead) / scale, 0, 0, 0});
  return std::move(parts.all);
}

}  // namespace passo
