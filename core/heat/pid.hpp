// PID control. The derivative is that of the measurement, and filtered; the integral has bounds.
// Control acts only within a range of the target. The heat loss by the fan is added in advance.
#pragma once
#include <algorithm>
#include <utility>

#include "heat/observer.hpp"
#include "heat/reading.hpp"

namespace passo::heat {

inline constexpr double kGainFull = 255;  // full power in units of the gains, as in M301

struct PidControl {
  double kp = 0, ki = 0, kd = 0;        // 1/255 of full power per °C, per °C·s, per °C/s
  double filter_s = 1;                  // time constant of the derivative
  double drive_min = 0, drive_max = 1;  // bounds of the integral, as fractions of full power
  double range_c = 10;                  // outside of this range of the target: full power, or off
  bool operator==(const PidControl&) const = default;
};

class Pid {
 public:
  explicit Pid(const PidControl& options) : o_(options) {}
  // New gains apply at once. The integral does not jump, because it is stored as power.
  void set(const PidControl& options) { o_ = options; }
  const Terms& terms() const { return terms_; }

  double update(const Reading& r) {
    if (r.dt > 0 && known_) {
      double rate = (r.celsius - before_) / r.dt;
      rate_ += (rate - rate_) * (r.dt / (r.dt + o_.filter_s));
      trend_ += (rate - trend_) * (r.dt / (r.dt + kTrend * o_.filter_s));
    }
    before_ = r.celsius;
    known_ = true;
    if (r.target <= 0) {
      i_ = o_.drive_min;
      blown_ = fan_ = target_ = 0;
      terms_ = {};
      return 0;
    }
    double error = r.target - r.celsius;
    double low = std::min(o_.drive_min, r.max_power), high = std::min(o_.drive_max, r.max_power);
    // For a lower target the integral is scaled with the target's distance from room temperature.
    // While the heater is still heating, the integral is too small: that costs time, but causes no
    // overshoot.
    double room = (r.body ? r.body->model() : HeatModel{}).ambient_c;
    if (target_ > room && r.target < target_) {
      double part = std::max(0.0, (r.target - room) / (target_ - room));
      i_ *= part;
      fan_ *= part;
      blown_ *= part;
      falls_ = true;
    }
    target_ = r.target;
    if (error >= -o_.range_c) falls_ = false;
    if (error < -o_.range_c && !falls_) i_ = low;  // the integral is too large
    // The power for the fan is added at once, before the sensor shows the loss. If the bounds cut
    // off a part of it when the fan starts, that part is not subtracted when the fan stops.
    double blown = r.body ? r.body->blown(r.target) : 0;
    double more = std::max(blown - std::exchange(blown_, blown), -fan_), was = i_;
    i_ = std::clamp(i_ + more, low, high);
    fan_ = std::max(0.0, fan_ + i_ - was);
    bool far = error > o_.range_c || error < -o_.range_c;
    near_s_ = far ? 0 : near_s_ + r.dt;
    if (error > o_.range_c) return finish(error, 0, 0, r.max_power, r.max_power);
    if (error < -o_.range_c) return finish(error, 0, 0, 0, r.max_power);
    double p = o_.kp / kGainFull * error, d = -o_.kd / kGainFull * rate_;
    double step = o_.ki / kGainFull * error * r.dt;
    // Anti-windup: the integral changes only if that changes the power. It also stays while the
    // temperature approaches the target faster than the integral could follow, which would cause
    // overshoot.
    double wanted = p + i_ + step + d;
    bool saturated = (wanted > r.max_power && step > 0) || (wanted < 0 && step < 0);
    bool closing = error * trend_ > 0 && o_.ki * error * error < o_.kp * error * trend_;
    bool approaching = closing && near_s_ < kApproachSeconds;
    if (!saturated && !approaching) i_ += step;
    i_ = std::clamp(i_, low, high);
    return finish(error, p, d, p + i_ + d, r.max_power);
  }

 private:
  static constexpr double kApproachSeconds = 30;
  static constexpr double kTrend =
      4;  // the trend is averaged over this many filter times, more than one ADC step

  PidControl o_;
  double before_ = 0, rate_ = 0, trend_ = 0, near_s_ = 0, i_ = 0;
  double target_ = 0;                   // the target of the integral
  double blown_ = 0, fan_ = 0;          // the loss by the fan, and its part in the integral
  bool known_ = false, falls_ = false;  // falls_: the temperature is falling to a lower target
  Terms terms_;

  double finish(double error, double p, double d, double output, double max_power) {
    output = std::clamp(output, 0.0, max_power);
    terms_ = {error, p, i_, d, output};
    return output;
  }
};

}  // namespace passo::heat
