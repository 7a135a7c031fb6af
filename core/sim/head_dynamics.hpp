// How head and bed of a simulated printer really move, and what the nozzles extrude: from executed
// steps alone.
#pragma once
#include <array>
#include <cstddef>
#include <deque>
#include <memory>
#include <utility>
#include <vector>

#include "geometry/geometry.hpp"
#include "sim/belt_mass.hpp"
#include "sim/nozzle_pressure.hpp"
#include "sim/step_track.hpp"

namespace passo::wire {

// One mass on a belt for each of X, Y and Z. On a machine whose motors do not move one axis each,
// the forward map of its geometry gives the axes from the motors. Clocks are those of the main
// board; all calls with a clock are in the order of time.
class HeadDynamics {
 public:
  // The first motors are those of the geometry's actuators, the next ones push the filament of one
  // nozzle each.
  HeadDynamics(double clock_hz, std::shared_ptr<const Geometry> geometry,
               const std::array<BeltMass, 3>& masses, const std::vector<NozzlePressure>& nozzles,
               const std::vector<TrackedMotor>& motors);
  ~HeadDynamics() { follow(false); }
  HeadDynamics(const HeadDynamics&) = delete;
  HeadDynamics& operator=(const HeadDynamics&) = delete;

  size_t actuators() const { return size_t(geometry_->actuators()); }
  // A motor's board and step pin.
  void connect(size_t motor, Bench& board, uint32_t step_pin);
  // Begins to follow the steps of the connected motors, from the positions where they are, all at
  // rest; or ends it. While nothing follows them, boards keep nothing.
  void follow(bool on);
  // Steps that were executed, of a motor that is not connected.
  void add_steps(size_t motor, const std::vector<StepRun>& runs) { tracks_.at(motor).add(runs); }
  // Sets the positions of the motors of the actuators, without steps, at a clock at which they are
  // at standstill.
  void place(double clock, std::vector<double> positions) {
    places_.push_back({clock, std::move(positions)});
  }

  // Everything at a clock. The boards must have run up to it; a board that has not makes up for it
  // later, as if its steps came later.
  void run(double clock) {
    take(clock);
    advance(clock);
  }
  // The two parts of it: the steps of the boards up to a clock, and the motion by known steps.
  void take(double clock);
  void advance(double clock);

  // At the clock of the last call of `run`, for an axis:
  double motor_mm(int axis) const { return motor_[axis]; }
  double mm(int axis) const { return motor_[axis] + masses_[size_t(axis)].deviation(); }
  const BeltMass& mass(int axis) const { return masses_[size_t(axis)]; }
  size_t nozzles() const { return nozzles_.size(); }
  const NozzlePressure& nozzle(size_t extruder) const { return nozzles_[extruder]; }
  // The clock of the last step that was made.
  double last_step() const { return last_step_; }
  // The clock of the next known step; infinite if there is none.
  double next_step() const;

 private:
  struct Source {
    std::weak_ptr<Bench*> board;
    uint32_t step_pin = 0;
  };
  double hz_, last_step_ = 0;
  std::shared_ptr<const Geometry> geometry_;
  bool linear_ = true;
  double columns_[3][3] = {};  // by how much an actuator moves each axis, if it is linear
  std::array<BeltMass, 3> masses_;
  std::array<double, 3> moved_{};  // clock up to which a mass has run
  std::vector<NozzlePressure> nozzles_;
  std::vector<double> pushed_;  // likewise, of a nozzle
  std::vector<StepTrack> tracks_;
  std::vector<Source> sources_;
  std::deque<std::pair<double, std::vector<double>>> places_;
  double motor_[3] = {};

  bool forward(double p[3]) const;
  void settle();
  void make_steps(double clock);
  void step(size_t motor, double clock);
  void move(int axis, double clock, double du);
};

}  // namespace passo::wire
