// The steps of one motor along the filtered law of its axes.
#pragma once
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "filters/advance.hpp"
#include "filters/nozzle_law.hpp"
#include "filters/smooth_law.hpp"
#include "filters/taps.hpp"
#include "machine/machine.hpp"
#include "plan/move.hpp"
#include "steps/cubic_solver.hpp"
#include "steps/interval_solver.hpp"
#include "steps/piece_solver.hpp"
#include "steps/step_solver.hpp"
#include "steps/steps.hpp"

namespace passo {

// Each interval has a closed form for a linear motor, and is a cubic for an extruder with advance
// and where jerk is limited.
// A nonlinear motor, or a motor that corrects an uneven bed, follows the filtered path of the
// nozzle. At standstill, the number of steps equals that of the plan.
class FilteredSolver {
 public:
  // `nozzle` solves and restarts with the same moves, before.
  FilteredSolver(const Machine& machine, const StepperSpec& spec, const NozzleLaw& nozzle);

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
  // One of four: a sum of impulses of all axes, an extruder's advance, a law of limited jerk, or
  // none, of a motor that follows the nozzle.
  std::optional<Taps> taps_;
  std::optional<Advance> advance_;
  std::optional<SmoothLaw> smooth_;
  const NozzleLaw& nozzle_;
  std::unique_ptr<IntervalSolver> intervals_;
  std::unique_ptr<CubicSolver> cubics_;
  std::optional<CubicSteps> cubic_steps_;  // of smooth_
  std::unique_ptr<PieceSolver> pieces_;
  // Quadratics with bends (IntervalSolver) that are near the motor's law, in steps and ticks.
  struct Fit {
    Track track;  // of parts of an interval
    Followed law;
    UnsetDoubles accel, odd, even;
  };
  Fit fit_;
  std::deque<Fit> parts_;  // by depth

  bool going_ = false;
  bool raised_ = false;
  double goal_[kAxes];  // end of the last move
  int64_t owed_ = 0;    // steps of the law that are not executed yet; negative: executed too early
  double owed_since_ = 0;
  TimedTolerances tolerances_;
  Steps late_;

  void set_up();
  void begin(const Move& m);
  void add(const Move& m, double until);
  void start(double clock);
  int64_t law_count() const;
  // Fits quadratics to the motor's law along a track.
  void fit(const Track& track, Fit& to) const;
  // Passes them on; splits those that are too far from the law.
  void pass_on(const Track& track, const Fit& fits, size_t depth);
  void solve_raised(StepSolver& of, Steps& out);
  void pay(Steps& steps, Steps& out);
};

}  // namespace passo
