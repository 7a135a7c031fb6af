// The ideal time of every step of one motor, from planned moves. Times are ticks since the start of
// the job, unrounded.
#pragma once
#include <cmath>
#include <cstdint>
#include <vector>

#include "machine/machine.hpp"
#include "plan/move.hpp"
#include "steps/piece_solver.hpp"
#include "steps/steps.hpp"

namespace passo {

class StepSolver {
 public:
  StepSolver(const Machine& machine, const StepperSpec& spec);

  // The machine has another geometry.
  void use_geometry();

  int64_t count() const { return count_; }  // steps from the origin, after the moves solved so far
  void set_count(int64_t count) { count_ = count; }
  // Steps by which the motor is beyond its position (backlash.hpp); its counts include them.
  int64_t lead() const { return lead_; }
  void set_lead(int64_t lead) { lead_ = lead; }

  // Step count at a position: the target of every move is rounded from the absolute position.
  int64_t count_at(const double* p) const { return int64_t(std::floor(position(p) + 0.5)) + lead_; }

  // Appends the steps of the move.
  void solve(const Move& m, Steps& out);

  // Appends the steps of the piece.
  void solve(const Piece& p, Steps& out);

 private:
  const Machine& machine_;
  const StepperSpec& spec_;
  double hz_;
  bool linear_;
  int axis_ = -1;  // ≥ 0: of an axis or extruder, whose motor this is
  double c_[3];
  int64_t count_ = 0, lead_ = 0;
  Crossings crossings_;
  std::vector<double> owed_;  // path positions
  PieceSolver pieces_;

  double position(const double* p) const;

  void solve_linear(const Move& m, Steps& out);

  // Above a bed that is not flat: the phases of the move as pieces.
  void solve_raised(const Move& m, Steps& out);

  void solve_path(const Move& m, Steps& out);
};

}  // namespace passo
