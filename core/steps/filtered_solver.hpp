// The steps of one motor along the filtered law of its axes.
#pragma once
#include <cmath>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "filters/advance.hpp"
#include "filters/backlash.hpp"
#include "filters/nozzle_law.hpp"
#include "filters/planned_laws.hpp"
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
  double hz_, delay_;
  PlannedLaws planned_;  // none of a motor that follows the nozzle
  // One of four: a sum of impulses of all axes, an extruder's advance, a law of limited jerk, or
  // none, of a motor that follows the nozzle.
  std::optional<Taps> taps_;
  std::optional<Advance> advance_;
  std::optional<SmoothLaw> smooth_;
  Backlash backlash_;  // of taps_ or smooth_
  const FilteredSolver* original_;
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
  void start(double clock, bool resumes);
  // Returns the lead at the begin of motion.
  double begin_lead(double clock, double q, bool resumes);
  int64_t law_count() const;
  // Passes on taps_ or smooth_ as far as the law is certain, with the lead of the drive.
  template <class Law, class Sink>
  void follow(Law& law, double known, bool last, Sink& sink);
  // At the end of motion, whole: the sum of position and lead is rounded.
  int64_t resting_lead(StepSolver& of) const;
  // Fits quadratics to the motor's law along a track.
  void fit(const Track& track, Fit& to) const;
  // Passes them on; splits those that are too far from the law.
  void pass_on(const Track& track, const Fit& fits, size_t depth);
  void solve_raised(StepSolver& of, Steps& out);
  void pay(Steps& steps, Steps& out);
};

}  // namespace passo
