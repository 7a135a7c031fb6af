// How a simulated probe gets to the bed: it is fixed to the head, turned down by a servo, a pin of
// a BLTouch, or fetched from a dock.
#pragma once
#include <cstdint>

#include "link/device.hpp"

namespace passo::wire {

struct ProbeMechanism {
  enum class Kind : uint8_t { fixed, servo, bltouch, dock };

  Kind kind = Kind::fixed;
  double hz = 1;             // ticks in a second
  uint32_t control_pin = 0;  // of a servo or a BLTouch; 0: none
  double deploy_us = 0;      // pulses of a servo, µs
  double stow_us = 0;
  double dock[3] = {0, 0, 0};  // the nozzle where the probe is coupled, mm
  double leave[2] = {0, 0};    // and on the way on which it stays in the dock
  bool stowed_reads = false;   // what it reads while it is not in place
  bool jammed = false;         // a fault: it does not get into place

  // The servo's signal takes a pulse width, µs, at a clock; 0: none.
  void pulse(double width_us, Ticks clock);
  // Where the nozzle is now; to be called at least each kLookSeconds of a probe in a dock.
  void look(const double p[3]);
  // The reading of the probe at a clock. `touches`: if it is in place, it touches the bed.
  bool reads(bool touches, Ticks clock);

  static constexpr double kLookSeconds = 0.005;

 private:
  bool in_place_ = false;  // or on the way there
  bool near_ = false;      // the head is at the dock
  bool touch_ = false;     // of a BLTouch: a level in place of a pulse
  bool alarm_ = false;
  Ticks settled_ = 0;    // it has got where it is on its way to
  Ticks pulse_end_ = 0;  // of a BLTouch that was triggered

  void move(bool to_bed, Ticks clock);
};

}  // namespace passo::wire
