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

  // Whether a linear motor certainly makes no step on a line at constant Z above one cell, with its
  // count at `count`. This fast test is true for most moves of a layer.
  bool rests(const double* from, const double* to, int64_t count) const;

  // Appends the steps of a piece, beginning with `count`. With `ends_path`, also appends the steps
  // that are missing to `target`. Returns the new count.
  int64_t solve(const Piece& p, int64_t count, int64_t target, bool ends_path, Steps& out);

  // Throws std::invalid_argument if the motor cannot reach a position of the piece or exceeds its
  // maximum step rate. Samples the piece every kSampleMm, and at least kMinSamples times.
  void check(const Piece& p) const;

 private:
  static constexpr double kSampleMm = 1;  // within this an actuator turns at most twice
  static constexpr int kMinSamples = 16;
  static constexpr double kExact = 1e-3;  // steps; smaller movements back and forth may be missed

  const Machine& machine_;
  const StepperSpec& spec_;
  bool straight_ = true;
  double row_[kAxes];  // of a linear motor: factors of the axes
  std::vector<double> turns_, lines_;

  bool moves(const Piece& p) const;
  static int parts(const Piece& p);

  // The motor's position in steps over the seconds of a piece: a polynomial, or calculated by the
  // geometry.
  struct Straight;
  struct Curved;
  HeightMap::Lift lift_at(const Piece& p, double t) const;

  // Sets lines_ to 0, the times at which the path crosses a line of the height map or a bound of
  // its fade, and the end of the piece.
  void find_lines(const Piece& p);

  // Appends the steps from span[0] to span[1] seconds, divided into `parts` first.
  template <class Curve>
  int64_t solve_along(const Curve& curve, const Piece& p, const double* span, int parts,
                      int64_t count, Steps& out);
};

// Throws std::invalid_argument if the pieces do not join within kPieceJoint mm, starting at `from`,
// or if a motor cannot follow them. `filament`: position of the first piece's extruder.
inline constexpr double kPieceJoint = 1e-6;
void check_pieces(const Machine& machine, const std::vector<Piece>& pieces, const double* from,
                  double filament);

}  // namespace passo
