// The interface of a geometry for the planner and the step solver. Each geometry implements it in a
// file of its own, and registry.hpp lists it.
#pragma once
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include "base/uninitialised_vector.hpp"

namespace passo {

// A straight line in XYZ: P(s) = p0 + (p1 - p0) * s / length, 0 ≤ s ≤ length. `length` is the
// planner's path measure of the move, usually its Euclidean length in mm.
struct Path {
  double p0[3], p1[3];
  double length;
};

struct Track;
struct Followed;

// The points of a path at which the step count of an actuator crosses a half-integer. The count
// goes from k0 to k1, which are rint(position * steps_per_unit) at both ends, with one crossing for
// each step.
struct Crossings {
  struct Run {
    int32_t first;  // index in `s` of the first crossing
    int32_t dir;    // +1 or -1
  };
  double near = 0;        // of the caller: the motor's step count before the path
  int64_t k0 = 0;         // step count at the start; of a motor that turns without end, near `near`
  UnsetDoubles s;         // path positions, ascending within 0…length
  std::vector<Run> runs;  // runs of one direction, as long as possible; empty if there is no step
  void clear() {
    k0 = 0;
    s.clear();
    runs.clear();
  }
};

class Geometry {
 public:
  static constexpr int kMostActuators = 8;

  virtual ~Geometry() = default;
  // Number of actuators that move the nozzle in X, Y and Z, at most kMostActuators.
  virtual int actuators() const = 0;
  // True if actuator i is linear: its position is c·(x, y, z). Then the solver uses a closed form,
  // and does not call slopes() or crossings().
  virtual bool linear(int i, double c[3]) const = 0;
  // Position of actuator i at p, in mm or degrees; NaN if it cannot reach p.
  virtual double inverse(int i, const double p[3]) const = 0;
  // The period of actuator i if it may turn without end: positions that differ by this are one
  // place, and inverse() returns any of them. 0: each position is a place of its own.
  virtual double turn(int) const { return 0; }
  // Position of the nozzle if the actuators are at q. Returns false for an impossible q.
  virtual bool forward(const double* q, double p[3]) const = 0;
  // First and second derivative of actuator i's position with respect to the path position s.
  virtual void slopes(int i, const Path& path, double s, double& d1, double& d2) const = 0;
  // Calculates all crossings of actuator i.
  virtual void crossings(int i, const Path& path, double steps_per_unit, Crossings& out) const = 0;
  // Positions and speeds of actuator i along a track (track.hpp). This implementation estimates the
  // error from the speed in the middle of an interval. It assumes at most two turns within 1 mm.
  virtual void follow(int i, const Track& track, Followed& out) const;
  // Whether the straight line between two points would make an arm turn back by a full turn.
  virtual bool jumps(const double[3], const double[3]) const { return false; }
  // Whether a line passes a place where an actuator would have to turn at once, although its ends
  // do not. Then `via` is a point beside that place, at `share` of the line, through which two
  // lines lead round it.
  virtual bool leads_round(const double[3], const double[3], double[3], double&) const {
    return false;
  }
  // The shortest distance in mm on which the slopes may change completely, within `around` mm of p.
  // It is small where an actuator turns fast.
  virtual double grain(const double[3], double) const {
    return std::numeric_limits<double>::infinity();
  }
};

// The position of actuator i, in steps, that is nearest to `near` among those at the same place as
// `steps`. A motor that turns without end so keeps its turns: its step count is their memory.
inline double nearest_turn(const Geometry& geometry, int i, double steps_per_unit, double steps,
                           double near) {
  const double period = geometry.turn(i) * steps_per_unit;
  return period > 0 ? steps + period * std::floor((near - steps) / period + 0.5) : steps;
}

}  // namespace passo
