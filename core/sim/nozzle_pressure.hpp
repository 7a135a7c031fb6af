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
  void step(double de) { flow_ += de / tau_; }
  void rest() { flow_ = 0; }

  // Filament that leaves the nozzle, mm/s.
  double flow() const { return flow_; }

 private:
  double tau_, flow_ = 0;
};

}  // namespace passo::wire
