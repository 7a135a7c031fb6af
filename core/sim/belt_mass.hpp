// A mass on a belt: the head, or the bed, of one axis. It vibrates when the motor accelerates.
#pragma once
#include <cmath>

namespace passo::wire {

// The mass at position x follows the motor at position u through a spring and a damper between belt
// and mass: with z = x - u, z" + 2 ζ ω z' + ω² z = -u". The motor moves only in steps: each step
// changes z by -Δu and the velocity by 2 ζ ω Δu. Between steps the mass vibrates freely, and its
// motion is calculated in closed form.
class BeltMass {
 public:
  // 0 < damping < 1, as a fraction of critical damping.
  BeltMass(double frequency_hz, double damping)
      : omega_(2 * M_PI * frequency_hz), decay_(damping * omega_),
        damped_(omega_ * std::sqrt(1 - damping * damping)) {}

  // Lets time pass without a step of the motor.
  void run(double seconds) {
    if (seconds <= 0 || (z_ == 0 && v_ == 0)) return;
    const double e = std::exp(-decay_ * seconds);
    const double c = e * std::cos(damped_ * seconds), s = e * std::sin(damped_ * seconds) / damped_;
    const double z = z_ * c + (v_ + decay_ * z_) * s;
    v_ = v_ * c - (decay_ * v_ + omega_ * omega_ * z_) * s;
    z_ = z;
  }
  // The motor moves by du mm at once.
  void step(double du) {
    z_ -= du;
    v_ += 2 * decay_ * du;
  }
  void rest() { z_ = v_ = 0; }

  // deviation(): position of the mass minus that of the motor, mm. Velocity in mm/s and
  // acceleration in mm/s² of the mass. The acceleration does not include the sudden change of
  // velocity at a step.
  double deviation() const { return z_; }
  double velocity() const { return v_; }
  double acceleration() const { return -2 * decay_ * v_ - omega_ * omega_ * z_; }
  // Amplitude in mm of the free vibration that this deviation and velocity belong to, with the
  // motor at standstill.
  double ringing() const { return std::hypot(z_, (v_ + decay_ * z_) / damped_); }

 private:
  double omega_, decay_, damped_;  // 1/s
  double z_ = 0, v_ = 0;
};

}  // namespace passo::wire
