#include "steps/filtered_solver.hpp"

#include <algorithm>
#include <cmath>

namespace passo {

FilteredSolver::FilteredSolver(const Machine& machine, const StepperSpec& spec,
                               const NozzleLaw& nozzle, const FilteredSolver* original)
    : machine_(machine), spec_(spec), law_(machine.clock_hz), original_(original ? original : this),
      nozzle_(nozzle), steps_(machine, spec) {
  use_gap();
}

void FilteredSolver::use_gap() {
  if (spec_.drive != Drive::actuator || spec_.index > kZ) return;
  const Gap& gap = machine_.filters.gaps.of[spec_.index];
  backlash_.set(gap.mm * spec_.steps_per_unit, gap.over_mm * spec_.steps_per_unit);
}

void FilteredSolver::add(const Move& m, double until, const StepSolver& of) {
  if (m.kind == MoveKind::dwell) {
    if (going_) law_.resume(std::min(m.end(), until));
    return;
  }
  const bool idle = spec_.drive == Drive::extruder && m.extruder != spec_.index;
  if (idle && !going_) return;
  if (!going_) {
    // At standstill: filters, scales and the height map may have changed.
    delay_ = machine_.filters.delay(machine_.clock_hz);
    law_.follow(machine_, spec_, nozzle_.track());
    law_.begin(m);
    steps_.expect(law_.parts());
    going_ = true;
    if (until == kNeverTicks) start(m.start, false, of);
  }
  law_.add(m, until);
  if (!idle) std::copy_n(m.p1, kAxes, goal_);
  tolerances_.add(m.start + delay_, m.tolerance);
}

void FilteredSolver::start(double clock, bool resumes, const StepSolver& of) {
  owed_since_ = clock;
  law_.start(clock);
  law_.keep_turns(double(of.count()));
  const double q = law_.q();
  if (takes_up_gap() && resumes)
    backlash_.resume(clock, q, original_->backlash_);
  else if (takes_up_gap())
    backlash_.begin(clock, q);
  steps_.begin(clock, q + (takes_up_gap() ? backlash_.lead() : 0));
}

void FilteredSolver::restart(double clock, const std::vector<Move>& past, StepSolver& of) {
  going_ = false;
  owed_ = 0;
  tolerances_ = {};
  for (const Move& m : past) add(m, clock, of);
  if (going_) {
    law_.resume(clock);
    start(clock, true, of);
    if (!counts_on()) owed_ = steps_.count() - of.count();
  } else {
    backlash_.stand(clock, original_->backlash_);
  }
  if (backlash_.on()) of.set_lead(lead());
}

void FilteredSolver::solve(const std::vector<Move>& moves, double known, bool last, StepSolver& of,
                           Steps& out) {
  const bool was_going = going_;
  for (const Move& m : moves) add(m, kNeverTicks, of);
  if (!going_) return;
  if (!was_going && !counts_on()) owed_ = steps_.count() - of.count();
  if (last) law_.stand();
  steps_.into(owed_ == 0 ? out : late_, tolerances_);
  if (counts_on()) steps_.begin(owed_since_, double(of.count() - of.lead()));
  pass_on(known, last);
  if (counts_on()) of.set_count(steps_.count() + of.lead());
  if (backlash_.on()) of.set_lead(lead());
  if (!counts_on()) {
    if (owed_ != 0) pay(late_, out);
    of.set_count(steps_.count() - owed_);
  }
  if (!last) return;
  going_ = false;
  owed_ = 0;
  if (takes_up_gap()) {
    backlash_.rest();
    of.set_lead(resting_lead(of));
  }
  // Sums over several axes round differently from the plan's position.
  const int64_t target = of.count_at(goal_), left = target - of.count();
  if (left == 0) return;
  const size_t n = size_t(std::abs(left));
  std::fill_n(out.extend(n, left > 0 ? 1 : -1), n, law_.t());
  of.set_count(target);
}

void FilteredSolver::pass_on(double known, bool last) {
  const double limit = known + law_.earliest();
  if (takes_up_gap()) {
    Backlash::Onto<LawSteps> leading{backlash_, steps_};
    law_.advance(limit, last, leading);
  } else {
    law_.advance(limit, last, steps_);
  }
  steps_.flush();
}

int64_t FilteredSolver::resting_lead(StepSolver& of) const {
  of.set_lead(0);
  const int64_t low = int64_t(std::floor(backlash_.lead()));
  const int64_t high = int64_t(std::ceil(backlash_.lead()));
  return std::clamp(steps_.count() - of.count_at(goal_), low, high);
}

// After a cut: steps that were due before it come at once. Steps that were executed too early are
// left out.
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

}  // namespace passo
