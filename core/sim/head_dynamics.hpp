// The real motion of head and bed of a simulated printer, and the real extrusion of its nozzles,
// calculated from executed steps only.
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

// One mass on a belt for each of X, Y and Z. The geometry converts motor positions to axes, if a
// motor does not move one axis. Clocks are those of the main board, and must not decrease from call
// to call.
class HeadDynamics {
 public:
  // The first motors are the actuators of the geometry. Each of the others pushes the filament of
  // one nozzle.
  HeadDynamics(double clock_hz, std::shared_ptr<const Geometry> geometry,
               const std::array<BeltMass, 3>& masses, const std::vector<NozzlePressure>& nozzles,
               const std::vector<TrackedMotor>& motors);
  ~HeadDynamics() { follow(false); }
  HeadDynamics(const HeadDynamics&) = delete;
  HeadDynamics& operator=(const HeadDynamics&) = delete;

  size_t actuators() const { return size_t(geometry_->actuators()); }
  // Connects a motor to its board and step pin.
  void connect(size_t motor, Bench& board, uint32_t step_pin);
  // Starts to follow the steps of the connected motors from their present positions, with
  // everything at rest; or stops. Boards keep executed steps only while they are followed.
  void follow(bool on);
  // Adds executed steps of a motor that is not connected.
  void add_steps(size_t motor, const std::vector<StepRun>& runs) { tracks_.at(motor).add(runs); }
  // Sets the actuator positions without steps, at a clock at which the motors are at standstill.
  void place(double clock, std::vector<double> positions) {
    places_.push_back({clock, std::move(positions)});
  }

  // Calculates everything up to a clock. All boards must have run up to it: if one lags behind, its
  // steps act later than they were made.
  void run(double clock) {
    take(clock);
    advance(clock);
  }
  // The two halves of run(): take() gets the steps from the boards, advance() calculates the
  // motion.
  void take(double clock);
  void advance(double clock);

  // State of an axis at the clock of the last run():
  double motor_mm(int axis) const { return motor_[axis]; }
  double mm(int axis) const { return motor_[axis] + masses_[size_t(axis)].deviation(); }
  const BeltMass& mass(int axis) const { return masses_[size_t(axis)]; }
  size_t nozzles() const { return nozzles_.size(); }
  const NozzlePressure& nozzle(size_t extruder) const { return nozzles_[extruder]; }
  // Clock of the last step made.
  double last_step() const { return last_step_; }
  // Clock of the next known step; infinite if none is known.
  double next_step() const;

 private:
  struct Source {
    std::weak_ptr<Bench*> board;
    uint32_t step_pin = 0;
  };
  double hz_, last_step_ = 0;
  std::shared_ptr<const Geometry> geometry_;
  bool linear_ = true;
  // Of each actuator, its factors for the axes, if the geometry is linear.
  double columns_[Geometry::kMostActuators][3] = {};
  std::array<BeltMass, 3> masses_;
  std::array<double, 3> moved_{};  // clock up to which each mass is calculated
  std::vector<NozzlePressure> nozzles_;
  std::vector<double> pushed_;  // clock up to which each nozzle is calculated
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
