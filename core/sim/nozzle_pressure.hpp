// A nozzle behind a spring of filament: the flow follows the extruder's speed late.
#pragma once
#include <cmath>

namespace passo::wire {

// First order, τ q' + q = e': filament (Hooke) presses molten plastic through the nozzle
// (Poiseuille). Exact between steps: q decays by e^(-t/τ), and each step of Δe adds Δe/τ.
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
  // Filament that leaves the nozzle, mm/s.
  double flow() const { return flow_; }
  // Filament that has left it since it was at rest, mm: the integral of the flow.
  double extruded() const { return pushed_ - tau_ * flow_; }

 private:
  double tau_, flow_ = 0, pushed_ = 0;
};

}  // namespace passo::wire
