// A nozzle with a spring of filament before it: the flow lags behind the extruder's speed.
#pragma once
#include <cmath>

namespace passo::wire {

// First-order lag, τ q' + q = e': the filament is a spring (Hooke) that presses plastic through the
// nozzle (Poiseuille). The calculation is exact: q decays by e^(-t/τ) between steps, and a step of
// Δe adds Δe/τ.
class NozzlePressure {
 public:
  explicit NozzlePressure(double time_constant_s) : tau_(time_constant_s) {}

  void run(double seconds) {
    if (seconds > 0 && flow_ != 0) flow_ *= std::exp(-seconds / tau_);
  }
  void step(double de) {
    flow_ += de / tau_;
    pushed_ += de;
  }
  void rest() { flow_ = pushed_ = 0; }

  double time_constant_s() const { return tau_; }
  // Speed at which filament leaves the nozzle, mm/s.
  double flow() const { return flow_; }
  // Length of filament that has left the nozzle since rest(), mm.
  double extruded() const { return pushed_ - tau_ * flow_; }

 private:
  double tau_, flow_ = 0, pushed_ = 0;
};

}  // namespace passo::wire
