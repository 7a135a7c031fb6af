// A mass on a belt: the head, or the bed, of one axis. It vibrates when the motor accelerates.
#pragma once
#include <cmath>

namespace passo::wire {

// The position x of the mass follows the position u of the motor through a spring and a damper,
// both between belt and mass: with z = x - u, z" + 2 ζ ω z' + ω² z = -u". The motor moves in steps
// only: each changes z by -Δu and the velocity by 2 ζ ω Δu, and between them the mass vibrates
// freely, in closed form. No step of a numeric integration is involved.
class BeltMass {
 public:
  // 0 < damping < 1, a fraction of the critical one.
  BeltMass(double frequency_hz, double damping)
      : omega_(2 * M_PI * frequency_hz), decay_(damping * omega_),
        damped_(omega_ * std::sqrt(1 - damping * damping)) {}

  // Lets time pass without a step.
  void run(double seconds) {
    if (seconds <= 0 || (z_ == 0 && v_ == 0)) return;
    const double e = std::exp(-decay_ * seconds);
    const double c = e * std::cos(damped_ * seconds), s = e * std::sin(damped_ * seconds) / damped_;
    const double z = z_ * c + (v_ + decay_ * z_) * s;
    v_ = v_ * c - (decay_ * v_ + omega_ * omega_ * z_) * s;
    z_ = z;
  }
  // The motor moves by du, mm, at once.
  void step(double du) {
    z_ -= du;
    v_ += 2 * decay_ * du;
  }
  void rest() { z_ = v_ = 0; }

  // Position of the mass minus that of the motor, mm; velocity in mm/s and acceleration in mm/s² of
  // the mass. A step changes the velocity at once, which the acceleration does not show.
  double deviation() const { return z_; }
  double velocity() const { return v_; }
  double acceleration() const { return -2 * decay_ * v_ - omega_ * omega_ * z_; }
  // Amplitude of the vibration in mm while the motor is at standstill: that of the free vibration
  // through this deviation and velocity.
  double ringing() const { return std::hypot(z_, (v_ + decay_ * z_) / damped_); }

 private:
  double omega_, decay_, damped_;  // 1/s
  double z_ = 0, v_ = 0;
};

}  // namespace passo::wire
