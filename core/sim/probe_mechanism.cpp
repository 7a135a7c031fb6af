#include "sim/probe_mechanism.hpp"

#include <cmath>

namespace passo::wire {

namespace {

constexpr double kTolerance = 30;     // tolerance of pulse widths, µs
constexpr double kMoveSeconds = 0.2;  // duration of a movement of the arm or pin
constexpr double kPulseSeconds = 0.01;
constexpr double kNearMm = 1;

// Pulse widths of a BLTouch, µs.
constexpr double kPinDown = 650, kTouchMode = 1165, kPinUp = 1475, kReset = 2190;

bool is(double width_us, double wanted_us) { return std::abs(width_us - wanted_us) < kTolerance; }

}  // namespace

void ProbeMechanism::move(bool to_bed, Ticks clock) {
  if (to_bed == in_place_ || (to_bed && jammed)) return;
  in_place_ = to_bed;
  settled_ = clock + Ticks(kMoveSeconds * hz);
}

void ProbeMechanism::pulse(double width_us, Ticks clock) {
  if (kind == Kind::servo) {
    if (is(width_us, deploy_us)) move(true, clock);
    if (is(width_us, stow_us)) move(false, clock);
  } else if (kind == Kind::bltouch) {
    if (is(width_us, kReset)) {
      alarm_ = touch_ = false;
      move(false, clock);
    } else if (is(width_us, kPinUp)) {
      touch_ = false;
      move(false, clock);
    } else if (is(width_us, kPinDown)) {
      touch_ = false;
      if (!alarm_) move(true, clock);
      alarm_ |= jammed;
    } else if (is(width_us, kTouchMode)) {
      touch_ = true;
    }
  }
}

void ProbeMechanism::look(const double p[3]) {
  const double x = p[0] - dock[0], y = p[1] - dock[1];
  const double far = std::hypot(x, y);
  const bool near = far <= kNearMm && std::abs(p[2] - dock[2]) <= kNearMm;
  if (near && !near_ && !in_place_ && !jammed) in_place_ = true;
  if (!near && near_ && in_place_) {
    const double to_x = leave[0] - dock[0], to_y = leave[1] - dock[1];
    if (x * to_x + y * to_y > 0.7 * far * std::hypot(to_x, to_y)) in_place_ = false;
  }
  near_ = near;
}

bool ProbeMechanism::reads(bool touches, Ticks clock) {
  if (kind == Kind::fixed) return touches;
  const bool there = in_place_ && settled_ <= clock;
  if (kind != Kind::bltouch) return there ? touches : stowed_reads;
  if (alarm_) return true;
  if (touch_) return !there || touches;
  if (there && touches) {  // the pin retracts by itself
    pulse_end_ = clock + Ticks(kPulseSeconds * hz);
    in_place_ = false;
  }
  return clock < pulse_end_;
}

}  // namespace passo::wire
