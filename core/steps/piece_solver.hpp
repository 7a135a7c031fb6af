// The steps of one motor along pieces, and along moves above a bed that is not flat.
#pragma once
#include <cstdint>
#include <vector>

#include "machine/machine.hpp"
#include "plan/pieces.hpp"
#include "steps/steps.hpp"

namespace passo {

class PieceSolver {
 public:
  PieceSolver(const Machine& machine, const StepperSpec& spec);

  // Whether the bed correction moves this motor.
  bool raised() const {
    return machine_.height_map && !machine_.joints && spec_.drive == Drive::actuator &&
           (!straight_ || row_[kZ] != 0);
  }

  // A straight motor makes no step from `count` on along a line at one Z above one cell: a cheap
  // test that most moves of a layer pass. Also false if the test is inconclusive.
  bool rests(const double* from, const double* to, int64_t count) const;

  // Appends each step from `count` on. At the end of a path, also appends the steps that are
  // missing to its rounded end, `target`. Returns the count after them.
  int64_t solve(const Piece& p, int64_t count, int64_t target, bool ends_path, Steps& out);

  // Throws std::invalid_argument if the motor cannot reach a position, or is too slow for the
  // piece. The path is sampled every kSampleMm, and at least kMinSamples times.
  void check(const Piece& p) const;

 private:
  static constexpr double kSampleMm = 1;  // within which an actuator turns at most twice
  static constexpr int kMinSamples = 16;
  static constexpr double kExact = 1e-3;  // steps: a turn forth and back by less may be missed

  const Machine& machine_;
  const StepperSpec& spec_;
  bool straight_ = true;
  double row_[kAxes];  // of a straight motor: its position by those of the axes
  std::vector<double> turns_, lines_;

  bool moves(const Piece& p) const;
  static int parts(const Piece& p);

  // Position in steps over the seconds of a piece, in closed form or by the geometry's inverse.
  struct Straight;
  struct Curved;
  HeightMap::Lift lift_at(const Piece& p, double t) const;

  // lines_: 0, the times at which the way crosses a line of the height map or an end of
  // its fade, and the piece's end.
  void find_lines(const Piece& p);

  // From span[0] to span[1] seconds, first sampled in so many parts.
  template <class Curve>
  int64_t solve_along(const Curve& curve, const Piece& p, const double* span, int parts,
                      int64_t count, Steps& out);
};

// Throws std::invalid_argument if pieces do not join from `from` on, to kPieceJoint mm, or a motor
// cannot follow one. `filament`: the position of the first piece's extruder.
inline constexpr double kPieceJoint = 1e-6;
void check_pieces(const Machine& machine, const std::vector<Piece>& pieces, const double* from,
                  double filament);

}  // namespace passo
