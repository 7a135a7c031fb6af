// The filtered path of the nozzle in X, Y and Z, for motors whose position is not a linear sum of
// the three.
#pragma once
#include <algorithm>
#include <vector>

#include "filters/law.hpp"
#include "geometry/track.hpp"
#include "machine/machine.hpp"
#include "plan/move.hpp"

namespace passo {

class NozzleLaw {
 public:
  explicit NozzleLaw(const Machine& machine) : machine_(machine) {}

  // Whether a motor of the machine needs this path.
  bool needed() const;
  // Takes the moves that follow the last ones. track() is then the next part of the path, as far as
  // later moves cannot change it. It starts at the end of the track before. Parameters as in
  // FilteredSolver::solve.
  void solve(const std::vector<Move>& moves, double known, bool last);
  // Restarts at `clock`, after the moves `past`. The track then has only that point.
  void restart(double clock, const std::vector<Move>& past);
  const Track& track() const { return track_; }

 private:
  struct Interval {
    double end;         // clock
    double q, v, a, j;  // at the start
  };
  // Collects the intervals of one axis.
  struct Intervals {
    std::vector<Interval> all;
    double q = 0;  // position at the end of the last interval
    void add(double end, double position, double speed, double, double accel) {
      all.push_back({end, q, speed, accel, 0});
      q = position;
    }
    void cubic(double t, double ticks, double begin, double speed, double accel, double jerk,
               double position, double) {
      all.push_back({t + ticks, begin, speed, accel, jerk});
      q = position;
    }
    // Axes never have these kinds of parts.
    template <class... Parts>
    void bent(const Parts&...) {}
    template <class... Parts>
    void counted(const Parts&...) {}
    void piece(const Piece&) {}
  };
  const Machine& machine_;
  Law laws_[3] = {Law(machine_.clock_hz), Law(machine_.clock_hz), Law(machine_.clock_hz)};
  Intervals axes_[3];
  double earliest_ = 0;
  bool going_ = false;
  Track track_;

  void begin(const Move& m);
  void add(const Move& m, double until);
  void start(double clock);
  void merge();
};

}  // namespace passo
