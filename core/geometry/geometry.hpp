// The interface of a geometry for the planner and the step solver. One file a geometry implements
// it; registry.hpp is the only other place that names it.
#pragma once
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

// Where an actuator crosses the half-integers of its step count along one path: the step count goes
// k0 → k1 = rint(position * steps_per_unit) at both ends, one crossing each step.
struct Crossings {
  struct Run {
    int32_t first;  // index in s of the first crossing of the run
    int32_t dir;    // +1 or -1
  };
  int64_t k0 = 0;         // step count where the path begins
  UnsetDoubles s;         // path positions, ascending within 0…length
  std::vector<Run> runs;  // maximal runs of one direction; empty if there is no step
  void clear() {
    k0 = 0;
    s.clear();
    runs.clear();
  }
};

class Geometry {
 public:
  virtual ~Geometry() = default;
  // Number of actuators that move the nozzle in X, Y, Z.
  virtual int actuators() const = 0;
  // True if actuator i is linear, position = c·(x, y, z): the solver then has a closed form of its
  // own and calls neither slopes nor crossings.
  virtual bool linear(int i, double c[3]) const = 0;
  // Position of actuator i (mm or degrees) at p, NaN where it cannot reach.
  virtual double inverse(int i, const double p[3]) const = 0;
  // Nozzle position of the actuators' positions q; false where there is none.
  virtual bool forward(const double* q, double p[3]) const = 0;
  // First and second derivative of actuator i's position by path length at s.
  virtual void slopes(int i, const Path& path, double s, double& d1, double& d2) const = 0;
  // All crossings of actuator i, with `steps_per_unit` steps to its unit.
  virtual void crossings(int i, const Path& path, double steps_per_unit, Crossings& out) const = 0;
  // Actuator i along a track (track.hpp). This one takes the error from the speed in the middle of
  // an interval; within 1 mm an actuator turns at most twice.
  virtual void follow(int i, const Track& track, Followed& out) const;
  // Whether an arm would have to turn back by a full turn on the straight line between two points.
  virtual bool jumps(const double[3], const double[3]) const { return false; }
  // The shortest path length, in mm, on which the slopes may change completely, within `around` mm
  // of p. It is small where an actuator must turn fast.
  virtual double grain(const double[3], double) const {
    return std::numeric_limits<double>::infinity();
  }
};

}  // namespace passo
