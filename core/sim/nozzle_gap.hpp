// The distance of the nozzle from the simulated bed during extrusion, calculated from executed
// steps only.
#pragma once
#include <array>
#include <cstddef>
#include <deque>
#include <memory>
#include <utility>
#include <vector>

#include "geometry/geometry.hpp"
#include "sim/bed.hpp"
#include "sim/step_track.hpp"

namespace passo::wire {

// Takes a sample every kSampleSeconds during the given spans, and at their ends. Steps, positions
// and spans must be added in the order of their clocks, which are those of the main board.
class NozzleGap {
 public:
  static constexpr double kSampleSeconds = 0.005;
  static constexpr int kCells = 24;  // number of cells along X and along Y of the bed

  // The first motors are the actuators of the geometry; others lift the gantry. `lifts` are those
  // of BedProbe, but with the number of the motor instead of its pin.
  NozzleGap(double clock_hz, std::shared_ptr<const Geometry> geometry, const Bed& bed,
            const std::vector<TrackedMotor>& motors, std::vector<Lift> lifts);

  // Sets the motor positions without steps, at a clock at which the motors are at standstill.
  void place(double clock, std::vector<double> positions) {
    places_.push_back({clock, std::move(positions)});
  }
  // Adds the steps of a motor up to `now`, a clock of its board. `all` is the number of its steps
  // since the start of the board. A command that is not finished is not among `runs`.
  void add_steps(size_t motor, const std::vector<StepRun>& runs, int64_t all, Ticks now);
  // A span in which the distance is sampled. `offset`: from the head to the nozzle of the tool in
  // use, mm.
  void add_span(double from, double to, const std::array<double, 3>& offset) {
    spans_.push_back({from, to, offset});
  }
  // Takes all samples up to the clock to which the steps of all motors are known.
  void advance();
  // Whether all spans are sampled.
  bool idle() const { return spans_.empty(); }

  struct Place {
    double gap, x, y;  // mm
  };
  struct Cell {
    double sum = 0;
    int samples = 0;
  };
  int samples() const { return samples_; }
  const Place& lowest() const { return lowest_; }
  const Place& highest() const { return highest_; }
  double mean() const { return samples_ > 0 ? sum_ / samples_ : 0; }
  // Rows from front to back, each from left to right. Positions outside of the bed count for the
  // cell at the edge.
  const std::vector<Cell>& cells() const { return cells_; }

 private:
  struct Track : StepTrack {
    using StepTrack::StepTrack;
    int64_t traced = 0;  // number of steps added so far
    double known = 0;    // all steps up to this clock are known
  };
  struct Set {
    double clock;
    std::vector<double> positions;
  };
  double hz_, at_ = 0;  // at_: clock of the next sample
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
  bool within_ = false;  // at_ is within the first span
  int samples_ = 0;
  double sum_ = 0;
  Place lowest_{}, highest_{};
  std::vector<Cell> cells_;

  void run(double clock);
  void sample_until(double clock);
  void sample(double clock, const std::array<double, 3>& offset);
};

}  // namespace passo::wire
