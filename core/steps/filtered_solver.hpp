// The steps of one motor along the filtered law of its axes.
#pragma once
#include <cmath>
#include <cstdint>
#include <vector>

#include "filters/backlash.hpp"
#include "filters/law.hpp"
#include "filters/nozzle_law.hpp"
#include "machine/machine.hpp"
#include "plan/move.hpp"
#include "steps/law_steps.hpp"
#include "steps/step_solver.hpp"
#include "steps/steps.hpp"

namespace passo {

// At standstill the step count equals that of the plan.
class FilteredSolver {
 public:
  // `nozzle` must be solved and restarted with the same moves first. A restart continues the motion
  // of `original`; null: its own motion.
  FilteredSolver(const Machine& machine, const StepperSpec& spec, const NozzleLaw& nozzle,
                 const FilteredSolver* original = nullptr);

  // Appends the steps of further moves, as far as later moves cannot change them. All moves up to
  // `known` are known. `last`: no move follows, and the motor stops. `of` holds the motor's count.
  void solve(const std::vector<Move>& moves, double known, bool last, StepSolver& of, Steps& out);

  // Restarts at `clock` after the moves `past`, which must include all that ended within the
  // filters' memory. Steps before `clock` are executed, and `of` holds their count.
  void restart(double clock, const std::vector<Move>& past, StepSolver& of);
  // Later restarts are not before `past`.
  void forget(double past) { backlash_.forget(past); }

  // Reads the gap of the drive again. Call this only at standstill.
  void use_gap();
  // Motion in this direction has closed the gap. Call this only at standstill.
  void lean(int dir) { backlash_.lean(dir); }
  int64_t lead_after(int dir) const { return int64_t(backlash_.lead_after(dir)); }
  // Steps of the motor beyond its position, to close the gap.
  int64_t lead() const { return int64_t(std::floor(backlash_.lead() + 0.5)); }

 private:
  const Machine& machine_;
  const StepperSpec& spec_;
  double delay_ = 0;  // of the filters, ticks
  Law law_;
  Backlash backlash_;  // unused while the law follows the nozzle
  const FilteredSolver* original_;
  const NozzleLaw& nozzle_;
  LawSteps steps_;

  bool going_ = false;
  double goal_[kAxes];  // end of the last move, mm
  int64_t owed_ =
      0;  // steps of the law that are due but not executed; negative: executed too early
  double owed_since_ = 0;
  TimedTolerances tolerances_;
  Steps late_;

  void add(const Move& m, double until, const StepSolver& of);
  void start(double clock, bool resumes, const StepSolver& of);
  bool takes_up_gap() const { return backlash_.on() && !law_.follows_nozzle(); }
  // Pieces have no step count of their own: their steps continue the motor's count.
  bool counts_on() const { return law_.parts() == PartKind::pieces; }
  // Passes on the certain part of the law, with the lead for the gap.
  void pass_on(double known, bool last);
  // The lead at the end of motion, as an integer: the sum of position and lead is rounded.
  int64_t resting_lead(StepSolver& of) const;
  void pay(Steps& steps, Steps& out);
};

}  // namespace passo
