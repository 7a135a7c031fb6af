// How a simulated probe is deployed: it is fixed to the head, turned down by a servo, the pin of a
// BLTouch, or picked up from a dock.
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
  double dock[3] = {0, 0, 0};  // nozzle position where the head picks up the probe, mm
  double leave[2] = {0, 0};    // X and Y of the path on which the probe stays in the dock
  bool stowed_reads = false;   // its reading while it is not deployed
  bool jammed = false;         // a fault: it does not deploy

  // The servo's signal takes a pulse width, µs, at a clock; 0: none.
  void pulse(double width_us, Ticks clock);
  // Sets the present nozzle position. With a probe in a dock, call it at least every
  // kSampleSeconds.
  void look(const double p[3]);
  // The reading of the probe at a clock. `touches`: if it is in place, it touches the bed.
  bool reads(bool touches, Ticks clock);

  static constexpr double kSampleSeconds = 0.005;

 private:
  bool in_place_ = false;  // or deploying
  bool near_ = false;      // the head is at the dock
  bool touch_ = false;     // of a BLTouch: a level in place of a pulse
  bool alarm_ = false;
  Ticks settled_ = 0;    // when the movement ends
  Ticks pulse_end_ = 0;  // of a BLTouch that was triggered

  void move(bool to_bed, Ticks clock);
};

}  // namespace passo::wire
