#include "steps/filtered_solver.hpp"

#include <algorithm>
#include <cmath>

namespace passo {

namespace {
// Later than any breakpoint, and before kNeverTicks.
constexpr double kAllTicks = 1e299;
}  // namespace

// Collects the intervals of one axis.
struct FilteredSolver::AxisLaw {
  std::vector<Interval>& to;
  double q;
  void add(double end, double position, double speed, double, double accel) {
    to.push_back({end, q, speed, accel});
    q = position;
  }
};

FilteredSolver::FilteredSolver(const Machine& machine, const StepperSpec& spec)
    : machine_(machine), spec_(spec), hz_(machine.clock_hz) {}

// At rest: filters, scales and the height map may have changed since.
void FilteredSolver::set_up() {
  const Filters& filters = machine_.filters;
  delay_ = filters.delay(hz_);
  const double span = filters.memory(hz_);
  pieces_ = std::make_unique<PieceSolver>(machine_, spec_);
  double c[3] = {0, 0, 0};
  const bool actuator = spec_.drive == Drive::actuator;
  const bool linear = !actuator || machine_.geometry->linear(spec_.index, c);
  raised_ = pieces_->raised();
  axes_ = 0;
  taps_.reset();
  advance_.reset();
  curved_.clear();
  phases_.clear();
  auto axis = [&](int slot, double scale) {
    slots_[axes_] = slot;
    scale_[axes_++] = scale;
  };
  if (!actuator)
    axis(spec_.drive == Drive::extruder ? int(kE) : slot_of_axis(spec_.index),
         spec_.steps_per_unit);
  else
    for (int j = 0; j < 3; ++j)
      if (!linear || raised_)
        axis(j, 1);
      else if (c[j] != 0)
        axis(j, c[j] * spec_.steps_per_unit);
  const bool advances = spec_.drive == Drive::extruder && filters.advances(size_t(spec_.index));
  phases_.reserve(3);
  for (int i = 0; i < axes_; ++i) phases_.emplace_back(advances);
  auto tap = [&](Taps& taps, int i) {
    const int slot = slots_[i];
    if (slot > kZ || filters.shapers[slot].empty()) return taps.add(&phases_[size_t(i)], 1, delay_);
    const auto& shaper = filters.shapers[slot];
    const double mean = Filters::mean(shaper);
    for (const Impulse& impulse : shaper)
      taps.add(&phases_[size_t(i)], impulse.weight, delay_ + (impulse.at - mean) * hz_);
  };
  if (advances) {
    const double half = filters.smooth_s[size_t(spec_.index)] * hz_;
    advance_.emplace(&phases_[0], half, delay_);
    if (!cubics_) cubics_ = std::make_unique<CubicSolver>();
  } else if (linear && !raised_) {
    taps_.emplace();
    for (int i = 0; i < axes_; ++i) tap(*taps_, i);
    if (!intervals_) intervals_ = std::make_unique<IntervalSolver>();
  } else {
    curved_.resize(3);
    for (int i = 0; i < 3; ++i) tap(curved_[size_t(i)], i);
  }
  for (Phases& p : phases_) p.begin(0, span);
}

void FilteredSolver::begin(const Move& m) {
  set_up();
  const double span = machine_.filters.memory(hz_);
  for (int i = 0; i < axes_; ++i) phases_[size_t(i)].begin(m.p0[slots_[i]] * scale_[i], span);
  going_ = true;
}

void FilteredSolver::add(const Move& m, double until) {
  if (m.kind == MoveKind::dwell) return;
  const bool idle = spec_.drive == Drive::extruder && m.extruder != spec_.index;
  if (idle && !going_) return;
  if (!going_) {
    begin(m);
    start(m.start);
  }
  for (int i = 0; i < axes_; ++i) {
    Phases& p = phases_[size_t(i)];
    const double at = p.at_end();
    const double from = idle ? at : m.p0[slots_[i]] * scale_[i];
    const double to = idle ? at : m.p1[slots_[i]] * scale_[i];
    p.add(m, from, to, hz_, idle ? 0 : m.advance * hz_, until);
  }
  if (!idle) std::copy_n(m.p1, kAxes, goal_);
  tolerances_.add(m.start + delay_, m.tolerance);
}

void FilteredSolver::start(double clock) {
  at_ = clock;
  if (advance_) {
    advance_->start(clock);
  } else if (taps_) {
    taps_->start(clock);
    intervals_->begin(clock, taps_->q());
  } else {
    for (size_t i = 0; i < 3; ++i) {
      curved_[i].start(clock);
      curved_at_[i] = curved_[i].q();
      laws_[i].clear();
    }
  }
}

int64_t FilteredSolver::law_count() const {
  return advance_ ? int64_t(advance_->count()) : intervals_->count();
}

double FilteredSolver::earliest() const {
  if (advance_) return advance_->earliest();
  if (taps_) return taps_->earliest();
  double least = delay_;
  for (const Taps& taps : curved_) least = std::min(least, taps.earliest());
  return least;
}

void FilteredSolver::restart(double clock, const std::vector<Move>& past, const StepSolver& of) {
  going_ = false;
  owed_ = 0;
  tolerances_ = {};
  for (const Move& m : past) add(m, clock);
  if (!going_) return;
  for (Phases& p : phases_) p.resume(clock);
  start(clock);
  if (curved_.empty()) owed_ = law_count() - of.count();
  owed_since_ = clock;
}

void FilteredSolver::solve(const std::vector<Move>& moves, double known, bool last, StepSolver& of,
                           Steps& out) {
  const bool was_going = going_;
  for (const Move& m : moves) add(m, kNeverTicks);
  if (!going_) return;
  if (!was_going && curved_.empty()) owed_ = law_count() - of.count(), owed_since_ = at_;
  if (last)
    for (Phases& p : phases_) p.stand();
  const double limit = last ? kAllTicks : known + earliest();
  Steps& to = owed_ == 0 ? out : late_;
  if (advance_) {
    cubics_->into(to, tolerances_);
    advance_->advance(limit, last, *cubics_);
    cubics_->flush();
    advance_->dropped(phases_[0].drop(advance_->needed()));
  } else if (taps_) {
    intervals_->into(to, tolerances_);
    taps_->advance(limit, last, *intervals_);
    intervals_->flush();
    for (Phases& p : phases_) taps_->dropped(&p, p.drop(taps_->needed(&p)));
  } else {
    solve_curved(limit, last, of, out);
  }
  if (curved_.empty()) {
    if (owed_ != 0) pay(late_, out);
    of.set_count(law_count() - owed_);
  }
  if (!last) return;
  going_ = false;
  owed_ = 0;
  // Sums of several axes are rounded otherwise than the plan's position.
  const int64_t target = of.count_at(goal_), left = target - of.count();
  if (left == 0) return;
  const double end = advance_ ? advance_->t() : taps_ ? taps_->t() : at_;
  const size_t n = size_t(std::abs(left));
  std::fill_n(out.extend(n, left > 0 ? 1 : -1), n, end);
  of.set_count(target);
}

// After a cut: what was due before it comes at once, and what was done before it is left out.
void FilteredSolver::pay(Steps& steps, Steps& out) {
  for (size_t r = 0; r < steps.runs.size(); ++r) {
    size_t first = steps.runs[r].first;
    const size_t end = r + 1 < steps.runs.size() ? steps.runs[r + 1].first : steps.ticks.size();
    const int dir = steps.runs[r].dir;
    if (owed_ != 0 && (owed_ > 0) == (dir > 0)) {
      const size_t n = size_t(std::abs(owed_));
      std::fill_n(out.extend(n, dir), n, owed_since_);
      owed_ = 0;
    }
    for (; owed_ != 0 && first < end; ++first) owed_ += dir;
    if (first == end) continue;
    std::copy_n(&steps.ticks[first], end - first, out.extend(end - first, dir));
  }
  if (!steps.widenings.empty()) out.set_tolerance(steps.widenings.back().tolerance);
  steps.ticks.clear();
  steps.runs.clear();
}

void FilteredSolver::solve_curved(double limit, bool last, StepSolver& of, Steps& out) {
  double end = at_;
  for (size_t i = 0; i < 3; ++i) {
    AxisLaw law{laws_[i], curved_at_[i]};
    curved_[i].advance(limit, last, law);
    curved_at_[i] = law.q;
    if (!laws_[i].empty()) end = std::max(end, laws_[i].back().end);
    curved_[i].dropped(&phases_[i], phases_[i].drop(curved_[i].needed(&phases_[i])));
  }
  size_t next[3] = {0, 0, 0};
  double from[3] = {at_, at_, at_};  // begin of the interval under way
  int64_t count = of.count();
  while (at_ < end) {
    double to = end;
    for (size_t i = 0; i < 3; ++i)
      if (next[i] < laws_[i].size()) to = std::min(to, laws_[i][next[i]].end);
    Piece p{};
    p.start = at_;
    p.seconds = (to - at_) / hz_;
    for (size_t i = 0; i < 3; ++i) {
      if (next[i] == laws_[i].size()) {
        p.c[i][0] = curved_at_[i];
        continue;
      }
      const Interval& law = laws_[i][next[i]];
      const double u = at_ - from[i];
      p.c[i][0] = law.q + u * (law.v + 0.5 * law.a * u);
      p.c[i][1] = (law.v + law.a * u) * hz_;
      p.c[i][2] = 0.5 * law.a * hz_ * hz_;
      if (law.end <= to) from[i] = law.end, ++next[i];
    }
    if (p.seconds > 0) {
      tolerances_.apply(at_, out);
      count = pieces_->solve(p, count, count, false, out);
    }
    at_ = to;
  }
  for (auto& laws : laws_) laws.clear();
  of.set_count(count);
}

}  // namespace passo
