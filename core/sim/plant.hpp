// The simulated printer around the virtual board: motors move actuators, actuators press switches,
// heaters warm bodies, thermistors feel them. It sees pins and clocks, as real parts would.
#pragma once
#include <algorithm>
#include <cstdint>
#include <deque>
#include <vector>

#include "heat/curve.hpp"
#include "link/device.hpp"
#include "sim/spi_device.hpp"
#include "sim/uart_line.hpp"

namespace passo::wire {

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

// A heated body and its sensor, each of first order: the body tends to ambient + rise * duty, and
// loses (1 + fan_loss * duty of the fan) times as much heat as it does without a fan.
struct HeatedBody {
  uint32_t heater_pin, sensor_pin;
  double ambient_c, rise_c, time_constant_s, sensor_time_constant_s;
  heat::Curve adc_ratio;  // °C → share of the ADC's full scale
  uint32_t fan_pin = 0;   // with a fan_loss of 0: none
  double fan_loss = 0;
  double body_c = 0, sensor_c = 0;

  // A pin's duty over the time since the last step.
  struct Mean {
    double duty = 0, sum = 0;  // sum: duty * ticks
    Ticks since = 0;
    void set(double value, Ticks clock) {
      add(clock);
      duty = value;
    }
    void add(Ticks clock) {
      if (clock <= since) return;
      sum += duty * double(clock - since);
      since = clock;
    }
    double take(Ticks end, Ticks step) {
      add(end);
      double mean = sum / double(step);
      sum = 0;
      return mean;
    }
  } heat, fan;

  // Faults: what the ADC sees instead, what the heater does instead, if ≥ 0; noise of the ADC as a
  // share of full scale; a sensor that hangs in the air.
  double forced_ratio = -1, forced_duty = -1, noise = 0;
  bool fallen = false;
};

class Plant {
 public:
  std::vector<Actuator> actuators;
  std::vector<Switch> switches;
  std::vector<HeatedBody> bodies;
  std::vector<uint32_t> low_is_on;  // output pins
  std::deque<UartLine> uarts;
  std::deque<SpiDevice> spi_devices;

  Plant(double clock_hz, uint32_t adc_max, Ticks start)
      : step_s_(kStepSeconds), step_ticks_(Ticks(kStepSeconds * clock_hz)), adc_max_(adc_max),
        done_(start) {}

  void add_body(HeatedBody body) {
    body.body_c = body.sensor_c = body.ambient_c;
    body.heat.since = body.fan.since = done_;
    bodies.push_back(std::move(body));
  }

  // An output pin is high for `duty` of the time from `clock` on.
  void set_output(uint32_t pin, Ticks clock, double duty) {
    if (std::find(low_is_on.begin(), low_is_on.end(), pin) != low_is_on.end()) duty = 1 - duty;
    for (HeatedBody& body : bodies) {
      bool fan = body.fan_loss > 0 && body.fan_pin == pin;
      if (body.heater_pin != pin && !fan) continue;
      run_until(clock);
      (fan ? body.fan : body.heat).set(duty, clock);
    }
  }
  // What the sensor on a pin shows at `clock`, as a share of full scale; 1 where there is none.
  double share(uint32_t pin, Ticks clock) {
    for (HeatedBody& body : bodies) {
      if (body.sensor_pin != pin) continue;
      run_until(clock);
      double ratio = body.forced_ratio >= 0 ? body.forced_ratio : body.adc_ratio.at(body.sensor_c);
      if (body.noise > 0) ratio = std::clamp(ratio + body.noise * random(), 0.0, 1.0);
      return ratio;
    }
    return 1;
  }
  uint32_t adc(uint32_t pin, Ticks clock) { return uint32_t(share(pin, clock) * adc_max_ + 0.5); }
  // A pin of a UART or an SPI bus takes a level.
  void edge(uint32_t pin, bool level, Ticks clock) {
    for (UartLine& line : uarts)
      if (line.tx_pin() == pin) line.edge(level, clock);
    for (SpiDevice& device : spi_devices) device.edge(pin, level, clock);
  }
  UartLine* uart(uint32_t rx_pin) {
    for (UartLine& line : uarts)
      if (line.rx_pin() == rx_pin) return &line;
    return nullptr;
  }
  SpiDevice* spi_device(uint32_t select_pin) {
    for (SpiDevice& device : spi_devices)
      if (device.pins().select == select_pin) return &device;
    return nullptr;
  }
  // Level of an input pin; position(step_pin) tells where a motor's actuator is.
  template <class Position>
  bool level(uint32_t pin, Ticks clock, Position&& position) {
    if (UartLine* line = uart(pin)) return line->level(clock);
    for (const SpiDevice& device : spi_devices)
      if (device.drives(pin)) return device.level();
    for (const Switch& s : switches) {
      if (s.pin != pin) continue;
      double at = 0;
      for (auto [step_pin, weight] : s.weights) at += weight * position(step_pin);
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
  // Somebody moves the actuator by hand.
  void place(uint32_t step_pin, int64_t net, double position) {
    for (Actuator& a : actuators)
      if (a.step_pin == step_pin) a.start = position - double(net) * a.per_step;
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
        double mean = body.heat.take(end, step_ticks_), fan = body.fan.take(end, step_ticks_);
        if (body.forced_duty >= 0) mean = body.forced_duty;
        double loss = (1 + body.fan_loss * fan) * (body.body_c - body.ambient_c);
        body.body_c += (body.rise_c * mean - loss) * (step_s_ / body.time_constant_s);
        double felt = body.fallen ? body.ambient_c : body.body_c;
        body.sensor_c += (felt - body.sensor_c) * (step_s_ / body.sensor_time_constant_s);
      }
    }
  }

 private:
  static constexpr double kStepSeconds = 0.02;
  double step_s_;
  Ticks step_ticks_;
  uint32_t adc_max_;
  Ticks done_;
  uint32_t random_ = 1;

  // -1…1, the same on every computer: a linear congruential generator (Numerical Recipes).
  double random() {
    random_ = random_ * 1664525u + 1013904223u;
    return double(random_) / 2147483648.0 - 1;
  }
};

}  // namespace passo::wire
