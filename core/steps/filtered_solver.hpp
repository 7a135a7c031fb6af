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

// At standstill, the number of steps equals that of the plan.
class FilteredSolver {
 public:
  // `nozzle` solves and restarts with the same moves, before. A restart continues the motion of
  // `original`; null: its own.
  FilteredSolver(const Machine& machine, const StepperSpec& spec, const NozzleLaw& nozzle,
                 const FilteredSolver* original = nullptr);

  // Appends the steps of moves that follow the last ones, as far as they are certain when all moves
  // up to `known` are; `last`: none follows, and the motor comes to rest. `of` has the motor's
  // count.
  void solve(const std::vector<Move>& moves, double known, bool last, StepSolver& of, Steps& out);

  // Continues at `clock` after the moves `past`, of which those are enough that end later than
  // `clock` less the filters' memory. Steps before `clock` are done, `of` has their count.
  void restart(double clock, const std::vector<Move>& past, StepSolver& of);
  // No restart is before `past` any more.
  void forget(double past) { backlash_.forget(past); }

  // The gap in the motor's drive may have changed. Only at rest.
  void use_gap();
  // Motion in this direction has taken up the gap. Only at rest.
  void lean(int dir) { backlash_.lean(dir); }
  int64_t lead_after(int dir) const { return int64_t(backlash_.lead_after(dir)); }
  // Steps by which the motor is beyond its position.
  int64_t lead() const { return int64_t(std::floor(backlash_.lead() + 0.5)); }

 private:
  const Machine& machine_;
  const StepperSpec& spec_;
  double delay_ = 0;  // of the law
  Law law_;
  Backlash backlash_;  // does not act while the law follows the nozzle
  const FilteredSolver* original_;
  const NozzleLaw& nozzle_;
  LawSteps steps_;

  bool going_ = false;
  double goal_[kAxes];  // end of the last move
  int64_t owed_ = 0;    // steps of the law that are not executed yet; negative: executed too early
  double owed_since_ = 0;
  TimedTolerances tolerances_;
  Steps late_;

  void add(const Move& m, double until);
  void start(double clock, bool resumes);
  bool takes_up_gap() const { return backlash_.on() && !law_.follows_nozzle(); }
  // Pieces have no place of their own: their steps continue the count of the motor.
  bool counts_on() const { return law_.parts() == PartKind::pieces; }
  // Passes on the law as far as it is certain, with the lead of the drive.
  void pass_on(double known, bool last);
  // At the end of motion, whole: the sum of position and lead is rounded.
  int64_t resting_lead(StepSolver& of) const;
  void pay(Steps& steps, Steps& out);
};

}  // namespace passo
