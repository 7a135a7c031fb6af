#include "sim/head_dynamics.hpp"

#include <algorithm>
#include <stdexcept>

namespace passo::wire {

HeadDynamics::HeadDynamics(double clock_hz, std::shared_ptr<const Geometry> geometry,
                           const std::array<BeltMass, 3>& masses,
                           const std::vector<NozzlePressure>& nozzles,
                           const std::vector<TrackedMotor>& motors)
    : hz_(clock_hz), geometry_(std::move(geometry)), masses_(masses), nozzles_(nozzles),
      pushed_(nozzles.size()), sources_(motors.size()) {
  if (motors.size() != actuators() + nozzles.size())
    throw std::invalid_argument("one motor for each actuator and each nozzle");
  for (const TrackedMotor& motor : motors) tracks_.emplace_back(motor);
  double unused[3];
  for (int i = 0; i < geometry_->actuators(); ++i) linear_ &= geometry_->linear(i, unused);
  if (linear_)
    for (size_t i = 0; i < actuators(); ++i) {
      std::vector<double> unit(actuators());
      unit[i] = 1;
      geometry_->forward(unit.data(), columns_[i]);
    }
  settle();
}

void HeadDynamics::connect(size_t motor, Bench& board, uint32_t step_pin) {
  sources_.at(motor) = {board.handle(), step_pin};
}

void HeadDynamics::follow(bool on) {
  for (size_t i = 0; i < sources_.size(); ++i) {
    const auto board = sources_[i].board.lock();
    if (!board) continue;
    (*board)->follow_steps(sources_[i].step_pin, on);
    if (on) tracks_[i].restart((*board)->position(sources_[i].step_pin));
  }
  if (!on) return;
  for (BeltMass& mass : masses_) mass.rest();
  for (NozzlePressure& nozzle : nozzles_) nozzle.rest();
  settle();
}

void HeadDynamics::advance(double clock) {
  while (!places_.empty() && places_.front().first <= clock) {
    const auto [at, positions] = std::move(places_.front());
    places_.pop_front();
    make_steps(at);
    for (size_t i = 0; i < actuators(); ++i) tracks_[i].position = positions.at(i);
    settle();
  }
  make_steps(clock);
  for (int axis = 0; axis < 3; ++axis) move(axis, clock, 0);
  for (size_t i = 0; i < nozzles_.size(); ++i) {
    nozzles_[i].run((clock - pushed_[i]) / hz_);
    pushed_[i] = clock;
  }
}

double HeadDynamics::next_step() const {
  double next = kInfinity;
  for (const StepTrack& track : tracks_) next = std::min(next, track.next());
  return next;
}

bool HeadDynamics::forward(double p[3]) const {
  double q[Geometry::kMostActuators];
  for (size_t i = 0; i < actuators(); ++i) q[i] = tracks_[i].position;
  return geometry_->forward(q, p);
}

// Moves the masses to the present positions of the motors.
void HeadDynamics::settle() {
  double p[3];
  if (forward(p)) std::copy_n(p, 3, motor_);
}

void HeadDynamics::take(double clock) {
  for (size_t i = 0; i < sources_.size(); ++i)
    if (const auto board = sources_[i].board.lock())
      tracks_[i].add(
          (*board)->take_followed(sources_[i].step_pin, Ticks(tracks_[i].own_clock(clock))));
}

void HeadDynamics::make_steps(double clock) {
  for (;;) {
    size_t first = 0;
    for (size_t i = 1; i < tracks_.size(); ++i)
      if (tracks_[i].next() < tracks_[first].next()) first = i;
    const double at = tracks_[first].next();
    if (at > clock) return;
    step(first, at);
    last_step_ = at;
  }
}

void HeadDynamics::step(size_t motor, double clock) {
  const double by = tracks_[motor].step();
  if (motor >= actuators()) {
    const size_t i = motor - actuators();
    nozzles_[i].run((clock - pushed_[i]) / hz_);
    nozzles_[i].step(by);
    pushed_[i] = std::max(pushed_[i], clock);
    return;
  }
  if (linear_) {
    for (int axis = 0; axis < 3; ++axis)
      if (columns_[motor][axis] != 0) move(axis, clock, columns_[motor][axis] * by);
    return;
  }
  double p[3];
  if (!forward(p)) return;
  for (int axis = 0; axis < 3; ++axis) move(axis, clock, p[axis] - motor_[axis]);
}

void HeadDynamics::move(int axis, double clock, double du) {
  BeltMass& mass = masses_[size_t(axis)];
  double& moved = moved_[size_t(axis)];
  mass.run((clock - moved) / hz_);
  moved = std::max(moved, clock);
  if (du == 0) return;
  mass.step(du);
  motor_[axis] += du;
}

}  // namespace passo::wire
