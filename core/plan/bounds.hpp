// The limits of a single move: its path measure, nominal speed and acceleration, with the names of
// the limits that bind them.
#pragma once
#include <vector>

#include "machine/constraints.hpp"
#include "machine/machine.hpp"
#include "plan/extrusion_flow.hpp"
#include "plan/junction.hpp"
#include "plan/move.hpp"
#include "plan/move_limits.hpp"

namespace passo {

class Bounds {
 public:
  explicit Bounds(const Machine& machine)
      : machine_(machine), junction_(machine), curved_(!Constraints(machine).actuators.empty()) {}

  bool nonlinear() const { return curved_ && !machine_.joints; }

  // Fills d, vn2, a, b, cartesian and the limits' names, and clears the fields of the budget. False
  // if the move covers no distance and takes no time.
  bool apply(Move& m, const Rules& rules) const;

  // Nonlinear geometries: tightens vn2 and a by the actuators' limits along the path, with its
  // curvature and that of an arc. Splits the move where these limits differ much, so that one slow
  // region does not slow down the whole line. With q', q'' the derivatives of an actuator by path
  // length: |q'| v ≤ V and |q''| v² + |q'| a ≤ A; half of A at most goes to curvature. Where the
  // bed is not flat, q' and q'' are the greatest that its steepest slope, up or down, makes of
  // them. Its creases, between the cells of the map, are no bends: there Z changes its speed at
  // once, by little. Samples are even, and closer together where the geometry bends sharply.
  void split(const Move& m, const Rules& rules, std::vector<Move>& parts);

  // The part of m between two fractions of its length.
  static void cut(const Move& m, double from, double to, Move& part);

 private:
  static constexpr double kNoDistance = 1e-9;    // mm
  static constexpr double kMinPathShare = 1e-4;  // of X, Y, Z, next to a longer axis
  static constexpr double kMaxAccel = 1e7;       // mm/s²
  static constexpr double kSampleEvery = 2;      // mm
  static constexpr int kMaxSamples = 256;
  static constexpr double kAlike = 0.7;    // neighbouring caps within this ratio are one part
  static constexpr double kOfBends = 0.5;  // fraction of an acceleration that bends may use

  struct Sample {
    double v, a, steps, bends;  // steps of all actuators by path length; curved_bends
    LimitId speed_id, accel_id;
  };
  const Machine& machine_;
  JunctionRule junction_;
  bool curved_;  // some actuators are nonlinear along a line
  struct SamplePoint {
    double fraction, s;  // of a move's length
  };
  std::vector<SamplePoint> points_;
  std::vector<Sample> samples_;

  void choose_points(const Move& m, double mm);

  static Sample worse(const Sample& x, const Sample& y);

  // Of an arc: the direction to its centre, or the opposite, and the acceleration towards it
  // divided by the square of the speed. The derivatives of a chord do not contain it.
  struct Turn {
    double to[3] = {0, 0, 0}, bend = 0;
  };
  static Turn turn_of(const Move& m);

  // The maximum correction of the bed along a move: first and second derivative by path length.
  struct Bed {
    double slope = 0, bend = 0;
  };
  Bed bed_below(const Move& m) const;

  // Upper bounds for the derivatives of actuator i at s. Along a line whose slope differs by k from
  // that of the path, q' = g + h k and q'' = e + b k + a k²; the bend of the bed moves the actuator
  // as Z does, by h.
  void slopes_above(const Bed& bed, int i, const Path& path, double s, double& q1,
                    double& q2) const;

  Sample sample(const Move& m, const Constraints& constraints, double s) const;
};

}  // namespace passo
