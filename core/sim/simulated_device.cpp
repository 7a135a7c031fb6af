#include "sim/simulated_device.hpp"

namespace passo::wire {

void Bench::feel(uint32_t step_pin, Bench& board, uint32_t its_step_pin) {
  elsewhere_[step_pin] = {board.self_, its_step_pin};
}

void Bench::place(uint32_t step_pin, double position) {
  plant_.place(step_pin, net(step_pin), position);
}

double Bench::felt(uint32_t step_pin) {
  auto elsewhere = elsewhere_.find(step_pin);
  if (elsewhere != elsewhere_.end())
    if (auto board = elsewhere->second.first.lock())
      return (*board)->position(elsewhere->second.second);
  return position(step_pin);
}

bool Bench::level(uint32_t pin, Ticks clock) { return plant_.level(pin, clock, felt_); }

}  // namespace passo::wire
