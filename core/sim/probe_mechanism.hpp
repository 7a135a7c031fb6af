// How a simulated probe is deployed: it is fixed to the head, moved by a servo, a BLTouch, or
// picked up from a dock.
#pragma once
#include <cstdint>

#include "link/device.hpp"

namespace passo::wire {

struct ProbeMechanism {
  enum class Kind : uint8_t { fixed, servo, bltouch, dock };

  Kind kind = Kind::fixed;
  double hz = 1;             // ticks per second
  uint32_t control_pin = 0;  // of a servo or BLTouch; 0: none
  double deploy_us = 0;      // pulse widths of a servo, µs
  double stow_us = 0;
  double dock[3] = {0, 0, 0};  // nozzle position where the head picks up the probe, mm
  double leave[2] = {0, 0};    // X and Y of a point: on the way there the probe stays in the dock
  bool stowed_reads = false;   // reading while the probe is not deployed
  bool jammed = false;         // a fault: the probe does not deploy

  // The servo signal changes to this pulse width, µs; 0: no pulses.
  void pulse(double width_us, Ticks clock);
  // Sets the nozzle position. For a probe with a dock, call it at least every kSampleSeconds.
  void look(const double p[3]);
  // The reading of the probe. `touches`: the probe touches the bed if it is deployed.
  bool reads(bool touches, Ticks clock);

  static constexpr double kSampleSeconds = 0.005;

 private:
  bool in_place_ = false;  // deployed or deploying
  bool near_ = false;      // the head is at the dock
  bool touch_ = false;     // a BLTouch reports a level instead of a pulse
  bool alarm_ = false;
  Ticks settled_ = 0;    // clock at which the movement ends
  Ticks pulse_end_ = 0;  // clock at which the pulse of a BLTouch ends

  void move(bool to_bed, Ticks clock);
};

}  // namespace passo::wire
