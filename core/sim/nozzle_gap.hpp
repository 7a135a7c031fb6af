// How far the nozzle is above the simulated bed while it extrudes, from executed steps alone.
#pragma once
#include <array>
#include <cstddef>
#include <deque>
#include <memory>
#include <utility>
#include <vector>

#include "base/types.hpp"
#include "geometry/geometry.hpp"
#include "sim/bed.hpp"
#include "sim/simulated_device.hpp"

namespace passo::wire {

// Looks at the nozzle every kLookSeconds of the given spans, and at their ends. Steps, places and
// spans come in the order of time; clocks are those of the main board.
class NozzleGap {
 public:
  static constexpr double kLookSeconds = 0.005;
  static constexpr int kCells = 24;  // along X and along Y of the bed

  // The motor of an actuator, or one of several that carry the gantry.
  struct Motor {
    double per_step;  // mm or degrees; negative if its steps count down
    double ratio;     // ticks of the main board in one of its own
    double offset;    // clock of the main board when its own reads 0
  };
  // The first motors are those of the geometry's actuators. `lifts` as those of a probe: the number
  // of the motor stands for its pin.
  NozzleGap(double clock_hz, std::shared_ptr<const Geometry> geometry, const Bed& bed,
            const std::vector<Motor>& motors, std::vector<Lift> lifts);

  // Without a step the motors are at these positions, from a clock on at which they stand.
  void place(double clock, std::vector<double> positions) {
    places_.push_back({clock, std::move(positions)});
  }
  // Steps that a motor has done up to `now` of its own clock, as far as they are traced; `all`: how
  // many it has done since its board began. A run that is half done is not traced yet.
  void add_steps(size_t motor, const std::vector<StepRun>& runs, int64_t all, Ticks now);
  // `offset` of the tool in use, mm: from the head to its nozzle.
  void add_span(double from, double to, const std::array<double, 3>& offset) {
    spans_.push_back({from, to, offset});
  }
  // Looks at all that is before the clock up to which the steps of all motors have come.
  void advance();
  // Nothing is left to look at.
  bool idle() const { return spans_.empty(); }

  struct Place {
    double gap, x, y;  // mm
  };
  struct Cell {
    double sum = 0;
    int looks = 0;
  };
  int looks() const { return looks_; }
  const Place& lowest() const { return lowest_; }
  const Place& highest() const { return highest_; }
  double mean() const { return looks_ > 0 ? sum_ / looks_ : 0; }
  // Rows from the front, each from the left; places beside the bed belong to its edge.
  const std::vector<Cell>& cells() const { return cells_; }

 private:
  struct Track {
    Motor motor;
    double position = 0;        // of the last step that has been passed
    std::deque<StepRun> ahead;  // the first one may be half done
    int64_t done = 0;           // steps of it
    int64_t traced = 0;         // steps that have come
    double known = 0;           // up to this clock they all have
  };
  struct Set {
    double clock;
    std::vector<double> positions;
  };
  double hz_, at_ = 0;  // at_: the next look
  std::shared_ptr<const Geometry> geometry_;
  Bed bed_;
  std::vector<Track> tracks_;
  std::vector<Lift> lifts_;
  std::deque<Set> places_;
  struct Span {
    double from, to;
    std::array<double, 3> offset;
  };
  std::deque<Span> spans_;
  bool within_ = false;  // the first span
  int looks_ = 0;
  double sum_ = 0;
  Place lowest_{}, highest_{};
  std::vector<Cell> cells_;

  static void run(Track& track, double clock);
  void run(double clock);
  void look_until(double clock);
  void look(double clock, const std::array<double, 3>& offset);
};

}  // namespace passo::wire
