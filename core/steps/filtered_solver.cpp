#include "steps/filtered_solver.hpp"

#include <algorithm>
#include <cmath>

namespace passo {

namespace {

// How far the calculated law may be from the exact one: by what the motor does in this time, or,
// where it turns, by less than any pulse shows.
constexpr double kNearSeconds = 1e-10, kNearSteps = 1e-8;
constexpr size_t kParts = 4, kDeepest = 20;
constexpr double kMostOdd = 0.0481126;  // of x (x - 1/2) (x - 1): sqrt(3) / 36

// From units of the actuator to steps, and from its polynomial of degree four to a quadratic with
// bends. error: at most 0 of the converter near enough.
PASSO_SIMD void fit_quadratics(int n, double per_unit, double near_ticks,
                               const double* __restrict t, const double* __restrict middle,
                               double* __restrict q, double* __restrict v0, double* __restrict v1,
                               double* __restrict a, double* __restrict odd,
                               double* __restrict even, double* __restrict error) {
  for (int i = 0; i < in_fours(n + 1); ++i) q[i] *= per_unit;
  for (int i = 0; i < in_fours(n); ++i) {
    const double d = t[i + 1] - t[i], per_tick = 1 / d;
    const double s0 = v0[i] * per_unit, s1 = v1[i] * per_unit, change = s1 - s0;
    const double mean = (q[i + 1] - q[i]) * per_tick;
    const double third = d * (s0 + s1 - 2 * mean);
    const double fourth = 16 * (middle[i] * per_unit - 0.5 * (q[i] + q[i + 1])) + 2 * d * change;
    const double f0 = std::fabs(s0), f1 = std::fabs(s1), least = f0 < f1 ? f0 : f1;
    const double slow = s0 * s1 > 0 ? least : 0.0, by_time = near_ticks * slow;
    const double near = by_time > kNearSteps ? by_time : kNearSteps;
    v0[i] = mean - 0.5 * change;
    v1[i] = mean + 0.5 * change;
    a[i] = change * per_tick;
    odd[i] = slow > 0 ? third : 0.0;
    even[i] = slow > 0 ? fourth : 0.0;
    // What a step of Newton's method leaves, or all of it where there may be a turn.
    const double bent = kMostOdd * std::fabs(third) + 0.0625 * std::fabs(fourth);
    const double left = bent * bent * std::fabs(a[i]) - 2 * by_time * slow * slow;
    const double flat = bent - kNearSteps, far = error[i] * per_unit - near;
    const double none = left < flat ? left : flat;
    error[i] = none > far ? none : far;
  }
}

}  // namespace

FilteredSolver::FilteredSolver(const Machine& machine, const StepperSpec& spec,
                               const NozzleLaw& nozzle, const FilteredSolver* original)
    : machine_(machine), spec_(spec), hz_(machine.clock_hz), planned_(hz_), nozzle_(nozzle),
      original_(original ? original : this) {
  use_gap();
}

void FilteredSolver::use_gap() {
  if (spec_.drive != Drive::actuator || spec_.index > kZ) return;
  const Gap& gap = machine_.filters.gaps[spec_.index];
  backlash_.set(gap.mm * spec_.steps_per_unit, gap.over_mm * spec_.steps_per_unit);
}

// At rest: filters, scales and the height map may have changed since.
void FilteredSolver::set_up() {
  const Filters& filters = machine_.filters;
  delay_ = filters.delay(hz_);
  pieces_ = std::make_unique<PieceSolver>(machine_, spec_);
  double c[3] = {0, 0, 0};
  const bool actuator = spec_.drive == Drive::actuator;
  const bool linear = !actuator || machine_.geometry->linear(spec_.index, c);
  raised_ = pieces_->raised();
  taps_.reset();
  advance_.reset();
  smooth_.reset();
  planned_.clear(filters);
  if (spec_.drive == Drive::extruder)
    planned_.follow_extruder(spec_.index, spec_.steps_per_unit);
  else if (!actuator)
    planned_.follow_axis(slot_of_axis(spec_.index), spec_.steps_per_unit);
  else if (linear && !raised_)
    for (int j = 0; j < 3; ++j)
      if (c[j] != 0) planned_.follow_axis(j, c[j] * spec_.steps_per_unit);
  const bool follows_nozzle = planned_.all().empty();
  if (!follows_nozzle && planned_.smooth())
    planned_.add_to(smooth_.emplace());
  else if (planned_.advances())
    advance_.emplace(&planned_.all()[0], filters.smooth_s[size_t(spec_.index)] * hz_, delay_);
  else if (!follows_nozzle)
    planned_.add_to(taps_.emplace());
  if ((smooth_ || advance_) && !cubics_) cubics_ = std::make_unique<CubicSolver>();
  if (!smooth_ && !advance_ && !intervals_) intervals_ = std::make_unique<IntervalSolver>();
  if (smooth_) cubic_steps_.emplace(*cubics_);
}

void FilteredSolver::begin(const Move& m) {
  set_up();
  planned_.begin(m);
  going_ = true;
}

void FilteredSolver::add(const Move& m, double until) {
  if (m.kind == MoveKind::dwell) {
    if (going_) planned_.resume(std::min(m.end(), until));
    return;
  }
  const bool idle = spec_.drive == Drive::extruder && m.extruder != spec_.index;
  if (idle && !going_) return;
  if (!going_) {
    begin(m);
    if (until == kNeverTicks) start(m.start, false);
  }
  planned_.add(m, until);
  if (!idle) std::copy_n(m.p1, kAxes, goal_);
  tolerances_.add(m.start + delay_, m.tolerance);
}

void FilteredSolver::start(double clock, bool resumes) {
  owed_since_ = clock;
  if (advance_) {
    advance_->start(clock);
  } else if (smooth_) {
    smooth_->start(clock);
    cubic_steps_->begin(smooth_->q() + begin_lead(clock, smooth_->q(), resumes));
  } else if (taps_) {
    taps_->start(clock);
    intervals_->begin(clock, taps_->q() + begin_lead(clock, taps_->q(), resumes));
  } else if (!raised_) {
    const Track& track = nozzle_.track();
    const double at[3] = {track.p[0][0], track.p[1][0], track.p[2][0]};
    const double q = machine_.geometry->inverse(spec_.index, at) * spec_.steps_per_unit;
    intervals_->begin(clock, q);
  }
}

double FilteredSolver::begin_lead(double clock, double q, bool resumes) {
  if (!backlash_.on()) return 0;
  if (resumes)
    backlash_.resume(clock, q, original_->backlash_);
  else
    backlash_.begin(clock, q);
  return backlash_.lead();
}

int64_t FilteredSolver::law_count() const {
  if (smooth_) return cubic_steps_->count();
  return advance_ ? int64_t(advance_->count()) : intervals_->count();
}

void FilteredSolver::restart(double clock, const std::vector<Move>& past, StepSolver& of) {
  going_ = false;
  owed_ = 0;
  tolerances_ = {};
  for (const Move& m : past) add(m, clock);
  if (going_) {
    planned_.resume(clock);
    start(clock, true);
    if (!raised_) owed_ = law_count() - of.count();
  } else {
    backlash_.stand(clock, original_->backlash_);
  }
  if (backlash_.on()) of.set_lead(lead());
}

void FilteredSolver::solve(const std::vector<Move>& moves, double known, bool last, StepSolver& of,
                           Steps& out) {
  const bool was_going = going_;
  for (const Move& m : moves) add(m, kNeverTicks);
  if (!going_) return;
  if (!was_going && !raised_) owed_ = law_count() - of.count();
  if (last) planned_.stand();
  Steps& to = owed_ == 0 ? out : late_;
  double end = 0;
  if (advance_) {
    cubics_->into(to, tolerances_);
    advance_->advance(last ? kAllTicks : known + advance_->earliest(), last, *cubics_);
    cubics_->flush();
    advance_->dropped(planned_.all()[0].drop(advance_->needed()));
    end = advance_->t();
  } else if (smooth_) {
    cubics_->into(to, tolerances_);
    follow(*smooth_, known, last, *cubic_steps_);
    cubics_->flush();
    end = smooth_->t();
  } else if (taps_) {
    intervals_->into(to, tolerances_);
    follow(*taps_, known, last, *intervals_);
    intervals_->flush();
    end = taps_->t();
  } else {
    const Track& track = nozzle_.track();
    end = track.t[track.n];
    if (raised_) {
      solve_raised(of, out);
    } else {
      intervals_->into(to, tolerances_);
      fit(track, fit_);
      pass_on(track, fit_, 0);
      intervals_->flush();
    }
  }
  if (backlash_.on()) of.set_lead(lead());
  if (!raised_) {
    if (owed_ != 0) pay(late_, out);
    of.set_count(law_count() - owed_);
  }
  if (!last) return;
  going_ = false;
  owed_ = 0;
  if (backlash_.on() && (taps_ || smooth_)) {
    backlash_.rest();
    of.set_lead(resting_lead(of));
  }
  // Sums of several axes are rounded otherwise than the plan's position.
  const int64_t target = of.count_at(goal_), left = target - of.count();
  if (left == 0) return;
  const size_t n = size_t(std::abs(left));
  std::fill_n(out.extend(n, left > 0 ? 1 : -1), n, end);
  of.set_count(target);
}

template <class Law, class Sink>
void FilteredSolver::follow(Law& law, double known, bool last, Sink& sink) {
  const double limit = last ? kAllTicks : known + law.earliest();
  if (backlash_.on()) {
    Backlash::Onto<Sink> leading{backlash_, sink};
    law.advance(limit, last, leading);
  } else {
    law.advance(limit, last, sink);
  }
  for (Phases& p : planned_.all()) law.dropped(&p, p.drop(law.needed(&p)));
}

int64_t FilteredSolver::resting_lead(StepSolver& of) const {
  of.set_lead(0);
  const int64_t low = int64_t(std::floor(backlash_.lead()));
  const int64_t high = int64_t(std::ceil(backlash_.lead()));
  return std::clamp(law_count() - of.count_at(goal_), low, high);
}

void FilteredSolver::fit(const Track& track, Fit& to) const {
  to.law.reserve(track.n);
  const size_t room = to.law.q.size();
  for (auto* x : {&to.accel, &to.odd, &to.even}) x->resize(room);
  machine_.geometry->follow(spec_.index, track, to.law);
  fit_quadratics(int(track.n), spec_.steps_per_unit, kNearSeconds * hz_, track.t.data(),
                 to.law.middle.data(), to.law.q.data(), to.law.v0.data(), to.law.v1.data(),
                 to.accel.data(), to.odd.data(), to.even.data(), to.law.error.data());
}

void FilteredSolver::pass_on(const Track& track, const Fit& fits, size_t depth) {
  const Followed& law = fits.law;
  for (size_t i = 0; i < track.n; ++i) {
    // Not a number at a singular point: smaller parts would be as bad.
    if (!(law.error[i] > 0) || depth == kDeepest) [[likely]] {
      intervals_->add(track.t[i + 1], law.q[i + 1], law.v0[i], law.v1[i], fits.accel[i],
                      fits.odd[i], fits.even[i]);
      continue;
    }
    if (parts_.size() == depth) parts_.emplace_back();
    Fit& parts = parts_[depth];
    parts.track.divide(track, i, kParts);
    fit(parts.track, parts);
    pass_on(parts.track, parts, depth + 1);
  }
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

void FilteredSolver::solve_raised(StepSolver& of, Steps& out) {
  const Track& track = nozzle_.track();
  int64_t count = of.count() - of.lead();
  for (size_t k = 0; k < track.n; ++k) {
    const double d = track.t[k + 1] - track.t[k];
    Piece p{};
    p.start = track.t[k];
    p.seconds = d / hz_;
    for (size_t i = 0; i < 3; ++i) {
      p.c[i][0] = track.p[i][k];
      p.c[i][1] = track.v0[i][k] * hz_;
      p.c[i][2] = 0.5 * (track.v1[i][k] - track.v0[i][k]) / d * hz_ * hz_;
      if (!track.cubic) continue;
      const double third = track.third(i, k) / (p.seconds * p.seconds);
      p.c[i][2] -= 1.5 * third;
      p.c[i][3] = third / p.seconds;
    }
    tolerances_.apply(track.t[k], out);
    count = pieces_->solve(p, count, count, false, out);
  }
  of.set_count(count + of.lead());
}

}  // namespace passo
