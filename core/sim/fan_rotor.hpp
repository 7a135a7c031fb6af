// The rotor of a simulated fan with a tachometer: its speed follows the power with a time constant.
#pragma once
#include <cstdint>

#include "link/device.hpp"

namespace passo::wire {

struct FanRotor {
  uint32_t fan_pin, tacho_pin;
  double full_hz;          // revolutions a second at full power
  double time_constant_s;  // of the speed
  double pulses;           // of the tachometer in a revolution; it is high during half of each
  double duty = 0, hz = 0, turns = 0;
  Ticks since = 0;  // `turns` are those at this clock

  // Faults: the rotor does not turn; the tachometer gives no pulses.
  bool stalled = false, silent = false;

  // The speed changes in steps of `step_s`, which are `step_ticks`.
  void step(double step_s, Ticks step_ticks) {
    turns += hz * step_s;
    since += step_ticks;
    hz = stalled ? 0 : hz + (full_hz * duty - hz) * (step_s / time_constant_s);
  }
  // `clock` is within a step of `since`.
  bool level(Ticks clock, double clock_hz) const {
    if (silent) return false;
    double at = turns + hz * double(clock - since) / clock_hz;
    return int64_t(at * pulses * 2) & 1;
  }
};

}  // namespace passo::wire
