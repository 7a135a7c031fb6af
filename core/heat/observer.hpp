// The host's model of a heated mass: a first-order body that loses heat to the room, and a
// first-order sensor. From power and readings it estimates the temperature of the body, and heat
// that the model does not explain.
#pragma once
#include <algorithm>
#include <cmath>

namespace passo::heat {

struct HeatModel {
  double rise_c = 0;           // final temperature rise above ambient at full power, without a fan
  double time_constant_s = 0;  // without a fan
  double sensor_lag_s = 0;
  double fan_loss = 0;    // additional heat loss by a fan at full speed, as a fraction
  double ambient_c = 25;  // temperature of the room
  bool operator==(const HeatModel&) const = default;
};

// A Luenberger observer with three states: sensor, body, and the room temperature that would
// explain the readings. Its poles are at -ω with ω = 0.5 / sensor lag: slower than the noise,
// faster than the body.
class Observer {
 public:
  explicit Observer(const HeatModel& model) : m_(model) {}
  void set(const HeatModel& model) { m_ = model; }
  const HeatModel& model() const { return m_; }

  // The next reading starts the observer again.
  void restart() { known_ = false; }
  // `power` was on for `dt` seconds before the sensor reported `celsius`.
  void update(double celsius, double power, double fan, double dt) {
    loss_ = 1 + m_.fan_loss * fan;
    if (!known_) {
      sensor_ = body_ = celsius;
      before_ = celsius;
      room_ = m_.ambient_c;
      known_ = true;
      return;
    }
    if (dt <= 0) return;
    double lag = std::max(m_.sensor_lag_s, 0.1);
    double a = 1 / lag, b = loss_ / m_.time_constant_s;
    double w = std::min(0.5 / lag, 0.5 / dt);
    double l1 = 3 * w - a - b, l2 = (3 * w * w - (a + l1) * b) / a, l3 = w * w * w / (a * b);
    int steps = std::max(1, int(std::ceil(dt / std::min(kStepSeconds, lag / 4))));
    double h = dt / steps;
    // The measured value is interpolated between the last two readings.
    for (int k = 1; k <= steps; ++k) {
      double measured = before_ + (celsius - before_) * (double(k) / steps);
      double off = measured - sensor_;
      double body_rate = b * (room_ + m_.rise_c * power / loss_ - body_);
      double sensor_rate = a * (body_ - sensor_);
      sensor_ += h * (sensor_rate + l1 * off);
      body_ += h * (body_rate + l2 * off);
      room_ += h * l3 * off;
    }
    before_ = celsius;
  }

  double body_c() const { return body_; }
  // The fraction of full power that holds the body at `celsius` now.
  double holding(double celsius) const { return loss_ * (celsius - room_) / m_.rise_c; }
  // The part of that power that the fan removes, at the model's ambient temperature.
  double blown(double celsius) const { return (loss_ - 1) * (celsius - m_.ambient_c) / m_.rise_c; }
  // The power that the readings show in addition to the model (negative: less), as a fraction of
  // full power.
  double unexplained() const { return loss_ * (room_ - m_.ambient_c) / m_.rise_c; }

 private:
  static constexpr double kStepSeconds = 0.05;

  HeatModel m_;
  double sensor_ = 0, body_ = 0, room_ = 0, loss_ = 1, before_ = 0;
  bool known_ = false;
};

}  // namespace passo::heat
