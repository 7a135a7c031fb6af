// Calculates the ideal time of each step of one motor from planned moves. Times are ticks since the
// start of the job, not rounded.
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

  // Reads the geometry of the machine again.
  void use_geometry();

  int64_t count() const { return count_; }  // after the moves solved so far
  void set_count(int64_t count) { count_ = count; }
  // Steps of the motor beyond its position (backlash.hpp). count() includes them.
  int64_t lead() const { return lead_; }
  void set_lead(int64_t lead) { lead_ = lead; }

  // Step count at a position. Every target is rounded from the absolute position. A motor that
  // turns without end keeps its turns.
  int64_t count_at(const double* p) const { return int64_t(std::floor(position(p) + 0.5)) + lead_; }

  void solve(const Move& m, Steps& out);

  void solve(const Piece& p, Steps& out);

 private:
  const Machine& machine_;
  const StepperSpec& spec_;
  double hz_;
  bool linear_;
  int axis_ = -1;  // if ≥ 0, this motor moves one axis or extruder
  double c_[3];
  int64_t count_ = 0, lead_ = 0;
  Crossings crossings_;
  std::vector<double> owed_;  // path positions
  PieceSolver pieces_;

  double position(const double* p) const;

  void solve_linear(const Move& m, Steps& out);

  // Solves a move with bed correction: its phases as pieces.
  void solve_raised(const Move& m, Steps& out);

  void solve_path(const Move& m, Steps& out);
};

}  // namespace passo
