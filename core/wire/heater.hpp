// A heater loop beside the link: each report of the sensor sets the power anew, so a host that
// stands still for a moment costs nothing, and a link that is lost lets the board switch the heater
// off.
#pragma once
#include <algorithm>
#include <cstdint>

#include "device.hpp"
#include "plant.hpp"

namespace passo::wire {

struct HeaterOptions {
  uint32_t sensor_oid, output_oid;
  bool pwm;             // queue_pwm_out, else queue_digital_out
  uint32_t full;        // value of full power: PWM_MAX, or the ticks of the software PWM's cycle
  uint32_t adc_full;    // a report of the sensor at the ADC's full scale
  double max_power;     // 0…1
  double kp, ki, kd;    // share of power by °C, °C·s, °C/s; kp 0: on/off control
  double hysteresis_c;  // of on/off control
  double tolerance_c;   // a target is reached within it
  Curve celsius;        // share of full scale → °C
};

class Heater {
 public:
  explicit Heater(HeaterOptions options) : o_(std::move(options)) {}

  const HeaterOptions& options() const { return o_; }
  double celsius() const { return celsius_; }
  double target() const { return target_; }
  double power() const { return power_; }
  // True from the first report within the tolerance of the target on, until the target changes.
  bool reached() const { return reached_; }
  void set_target(double celsius) {
    if (celsius != target_) reached_ = false;
    target_ = celsius;
    if (target_ <= 0) integral_ = 0;
  }

  // Takes a report (sum of samples) made at board clock `clock`; true if `value` must be sent.
  bool report(uint32_t sum, Ticks clock, double clock_hz, uint32_t& value) {
    double before = celsius_, dt = double(clock - clock_) / clock_hz;
    celsius_ = o_.celsius.at(double(sum) / o_.adc_full);
    if (known_ && dt > 0)
      rate_ += ((celsius_ - before) / dt - rate_) * (dt / (dt + kSmoothSeconds));
    double power = target_ > 0 ? std::clamp(control(known_ ? dt : 0), 0.0, o_.max_power) : 0;
    clock_ = clock;
    known_ = true;
    if (target_ > 0 && celsius_ >= target_ - o_.tolerance_c && celsius_ <= target_ + o_.tolerance_c)
      reached_ = true;
    bool send = power > 0 || power_ > 0;  // a heater that is on must be renewed
    power_ = power;
    value = uint32_t(power * o_.full + 0.5);
    return send;
  }

 private:
  static constexpr double kSmoothSeconds = 1;  // time constant of the derivative

  HeaterOptions o_;
  double target_ = 0, celsius_ = 0, rate_ = 0, integral_ = 0, power_ = 0;
  Ticks clock_ = 0;
  bool known_ = false, reached_ = false;

  double control(double dt) {
    double error = target_ - celsius_;
    if (o_.kp == 0) {
      if (power_ > 0) return error > -o_.hysteresis_c ? o_.max_power : 0;
      return error > o_.hysteresis_c ? o_.max_power : 0;
    }
    double fixed = o_.kp * error - o_.kd * rate_, step = o_.ki * error * dt;
    // Anti-windup: the integral grows only while that still changes the power.
    double wanted = fixed + integral_ + step;
    bool saturated = (wanted > o_.max_power && step > 0) || (wanted < 0 && step < 0);
    if (!saturated) integral_ = std::clamp(integral_ + step, 0.0, o_.max_power);
    return fixed + integral_;
  }
};

}  // namespace passo::wire
