// The simulated printer around the virtual board: motors move actuators, actuators press switches,
// heaters warm bodies, thermistors feel them. It sees pins and clocks, as real parts would.
#pragma once
#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "device.hpp"

namespace passo::wire {

// Piecewise linear function through points of ascending x; constant beyond both ends.
class Curve {
 public:
  Curve() = default;
  explicit Curve(std::vector<std::pair<double, double>> points) : points_(std::move(points)) {}
  double at(double x) const {
    if (points_.empty()) return 0;
    auto next = std::upper_bound(points_.begin(), points_.end(), x,
                                 [](double v, const auto& point) { return v < point.first; });
    if (next == points_.begin()) return points_.front().second;
    if (next == points_.end()) return points_.back().second;
    const auto &a = *(next - 1), &b = *next;
    return a.second + (b.second - a.second) * ((x - a.first) / (b.first - a.first));
  }

 private:
  std::vector<std::pair<double, double>> points_;
};

// The actuator of one motor: position = start + net steps * per_step (negative if the motor's
// direction pin is inverted). Units: mm, or degrees.
struct Actuator {
  uint32_t step_pin;
  double start, per_step;
};

// A switch that is pressed at or beyond `position`, seen from inside the travel, of what some
// actuators move together: the sum of their positions, each with its weight.
struct Switch {
  uint32_t pin;
  std::vector<std::pair<uint32_t, double>> weights;  // step pin, weight
  double position;
  bool at_maximum;
  bool pressed_level;
  int forced = -1;  // a fault: 0 never pressed, 1 always
};

// A heated body and its sensor, each of first order: the body tends to ambient + rise * duty.
struct HeatedBody {
  uint32_t heater_pin, sensor_pin;
  double ambient_c, rise_c, time_constant_s, sensor_time_constant_s;
  Curve adc_ratio;  // °C → share of the ADC's full scale
  double body_c = 0, sensor_c = 0;
  double duty = 0, energy = 0;  // energy: duty * ticks since the last step
  Ticks duty_since = 0;
  double forced_ratio = -1;  // a fault: what the ADC sees instead, if ≥ 0
};

class Plant {
 public:
  std::vector<Actuator> actuators;
  std::vector<Switch> switches;
  std::vector<HeatedBody> bodies;

  Plant(double clock_hz, uint32_t adc_max, Ticks start)
      : step_s_(kStepSeconds), step_ticks_(Ticks(kStepSeconds * clock_hz)), adc_max_(adc_max),
        done_(start) {}

  void add_body(HeatedBody body) {
    body.body_c = body.sensor_c = body.ambient_c;
    body.duty_since = done_;
    bodies.push_back(std::move(body));
  }

  // An output pin is on for `duty` of the time from `clock` on.
  void set_output(uint32_t pin, Ticks clock, double duty) {
    for (HeatedBody& body : bodies) {
      if (body.heater_pin != pin) continue;
      run_until(clock);
      body.energy += body.duty * double(clock - body.duty_since);
      body.duty_since = clock;
      body.duty = duty;
    }
  }
  uint32_t adc(uint32_t pin, Ticks clock) {
    for (HeatedBody& body : bodies) {
      if (body.sensor_pin != pin) continue;
      run_until(clock);
      double ratio = body.forced_ratio >= 0 ? body.forced_ratio : body.adc_ratio.at(body.sensor_c);
      return uint32_t(ratio * adc_max_ + 0.5);
    }
    return adc_max_;
  }
  // Level of an input pin; net(step_pin) tells the steps that a motor has made.
  template <class Net>
  bool level(uint32_t pin, Net&& net) const {
    for (const Switch& s : switches) {
      if (s.pin != pin) continue;
      double at = 0;
      for (auto [step_pin, weight] : s.weights) at += weight * position(step_pin, net(step_pin));
      bool pressed = s.at_maximum ? at >= s.position : at <= s.position;
      if (s.forced >= 0) pressed = s.forced > 0;
      return pressed == s.pressed_level;
    }
    return true;  // an open input with its pull-up
  }
  double position(uint32_t step_pin, int64_t net) const {
    for (const Actuator& a : actuators)
      if (a.step_pin == step_pin) return a.start + double(net) * a.per_step;
    return 0;
  }
  // The board forgets its counts; the actuators stay where they are.
  void rebase(uint32_t step_pin, int64_t net) {
    for (Actuator& a : actuators)
      if (a.step_pin == step_pin) a.start += double(net) * a.per_step;
  }

  // Fixed steps: the result does not depend on when it was asked for.
  void run_until(Ticks clock) {
    for (; done_ + step_ticks_ <= clock; done_ += step_ticks_) {
      for (HeatedBody& body : bodies) {
        Ticks end = done_ + step_ticks_;
        if (body.duty_since < end) {
          body.energy += body.duty * double(end - body.duty_since);
          body.duty_since = end;
        }
        double mean = body.energy / double(step_ticks_);
        body.energy = 0;
        double goal = body.ambient_c + body.rise_c * mean;
        body.body_c += (goal - body.body_c) * (step_s_ / body.time_constant_s);
        body.sensor_c += (body.body_c - body.sensor_c) * (step_s_ / body.sensor_time_constant_s);
      }
    }
  }

 private:
  static constexpr double kStepSeconds = 0.02;
  double step_s_;
  Ticks step_ticks_;
  uint32_t adc_max_;
  Ticks done_;
};

}  // namespace passo::wire
