// The steps of one motor along the filtered law of its axes.
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "filters/advance.hpp"
#include "filters/taps.hpp"
#include "machine/machine.hpp"
#include "plan/move.hpp"
#include "steps/cubic_solver.hpp"
#include "steps/interval_solver.hpp"
#include "steps/piece_solver.hpp"
#include "steps/step_solver.hpp"
#include "steps/steps.hpp"

namespace passo {

// Of a linear motor each interval has a closed form, of an extruder with advance a cubic; a
// nonlinear motor, or one above a bed that is not flat, follows the filtered X, Y and Z. The number
// of steps, when all is at rest, is that of the plan.
class FilteredSolver {
 public:
  FilteredSolver(const Machine& machine, const StepperSpec& spec);

  // Appends the steps of moves that follow the last ones, as far as they are certain when all moves
  // up to `known` are; `last`: none follows, and the motor comes to rest. `of` has the motor's
  // count.
  void solve(const std::vector<Move>& moves, double known, bool last, StepSolver& of, Steps& out);

  // Continues at `clock` after the moves `past`, of which those are enough that end later than
  // `clock` less the filters' memory. Steps before `clock` are done, `of` has their count.
  void restart(double clock, const std::vector<Move>& past, const StepSolver& of);

 private:
  const Machine& machine_;
  const StepperSpec& spec_;
  double hz_, delay_;
  int slots_[3] = {0, 0, 0};  // of the position, for each of the phases
  double scale_[3] = {0, 0, 0};
  int axes_ = 0;
  std::vector<Phases> phases_;
  // One of three: a sum of impulses of all axes, an extruder's advance, or a sum for each axis.
  std::optional<Taps> taps_;
  std::unique_ptr<IntervalSolver> intervals_;
  std::optional<Advance> advance_;
  std::unique_ptr<CubicSolver> cubics_;
  struct AxisLaw;
  std::vector<Taps> curved_;
  std::unique_ptr<PieceSolver> pieces_;
  struct Interval {
    double end, q, v, a;  // q, v: at its begin
  };
  std::vector<Interval> laws_[3];
  double at_ = 0, curved_at_[3] = {0, 0, 0};  // to where the intervals of a curved motor are done

  bool going_ = false;
  bool raised_ = false;
  double goal_[kAxes];  // end of the last move
  int64_t owed_ = 0;    // steps of the law that are not done, or, below 0, are already
  double owed_since_ = 0;
  TimedTolerances tolerances_;
  Steps late_;

  void set_up();
  void begin(const Move& m);
  void add(const Move& m, double until);
  void start(double clock);
  int64_t law_count() const;
  double earliest() const;
  void solve_curved(double limit, bool last, StepSolver& of, Steps& out);
  void pay(Steps& steps, Steps& out);
};

}  // namespace passo
