// The simulated printer around the virtual board: motors move actuators, actuators trigger
// endstops, heaters warm bodies, thermistors measure them. Its interface is pins and clocks, as for
// real parts.
#pragma once
#include <cstdint>
#include <deque>
#include <functional>
#include <utility>
#include <vector>

#include "heat/curve.hpp"
#include "link/device.hpp"
#include "sim/bed.hpp"
#include "sim/i2c_device.hpp"
#include "sim/spi_device.hpp"
#include "sim/uart_line.hpp"

namespace passo::wire {

// The actuator of one motor: position = start + net steps * per_step (negative if the motor's
// direction pin is inverted). Units: mm, or degrees.
struct Actuator {
  uint32_t step_pin;
  double start, per_step;
};

// An endstop that is triggered at or beyond `position`, seen from inside the travel, of the
// combined position of some actuators: the sum of their positions, each with its weight.
struct Switch {
  uint32_t pin;
  std::vector<std::pair<uint32_t, double>> weights;  // step pin, weight
  double position;
  bool at_maximum;
  bool pressed_level;
  int forced = -1;  // a fault: 0 never triggered, 1 always, 2 changes every kFlickerSeconds
  // The wheel of a filament sensor: with a length, the level changes each time the combined
  // position has moved by it.
  double edge_mm = 0;

  static constexpr double kFlickerSeconds = 0.005;
};

// A heated body and its sensor, each of first order: the body tends to ambient + rise * duty, and
// loses (1 + fan_loss * duty of the fan) times as much heat as it does without a fan.
struct HeatedBody {
  uint32_t heater_pin, sensor_pin;
  double ambient_c, rise_c, time_constant_s, sensor_time_constant_s;
  heat::Curve adc_ratio;  // °C → fraction of the ADC's full scale
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

  // Faults: the value that the ADC reads instead, the power of the heater instead, if ≥ 0; noise of
  // the ADC as a fraction of full scale; a detached sensor.
  double forced_ratio = -1, forced_duty = -1, noise = 0;
  bool fallen = false;
};

class Plant {
 public:
  std::vector<Actuator> actuators;
  std::vector<Switch> switches;
  std::vector<BedProbe> probes;
  std::vector<HeatedBody> bodies;
  std::vector<uint32_t> low_is_on;  // output pins
  std::deque<UartLine> uarts;
  std::deque<SpiDevice> spi_devices;
  std::deque<I2cDevice> i2c_devices;

  Plant(double clock_hz, uint32_t adc_max, Ticks start)
      : hz_(clock_hz), step_s_(kStepSeconds), step_ticks_(Ticks(kStepSeconds * clock_hz)),
        adc_max_(adc_max), done_(start) {}

  void add_body(HeatedBody body);
  void add_probe(BedProbe probe);

  // An output pin is high for `duty` of the time from `clock` on.
  void set_output(uint32_t pin, Ticks clock, double duty);
  // The reading of the sensor on a pin at `clock`, as a fraction of full scale; 1 if there is none.
  double share(uint32_t pin, Ticks clock);
  uint32_t adc(uint32_t pin, Ticks clock) { return uint32_t(share(pin, clock) * adc_max_ + 0.5); }
  // A pin of a UART, an SPI or an I2C bus takes a level.
  void edge(uint32_t pin, bool level, Ticks clock);
  UartLine* uart(uint32_t rx_pin);
  SpiDevice* spi_device(uint32_t select_pin);
  I2cDevice* i2c_device(I2cPins pins, uint8_t address);
  using Position = std::function<double(uint32_t step_pin)>;
  // Level of an input pin; position(step_pin) returns the position of a motor's actuator.
  bool level(uint32_t pin, Ticks clock, const Position& position);
  // Parts that sense the head's position take a sample; returns the time of their next one.
  void look(Ticks clock, const Position& position);
  Ticks next_look() const { return next_look_; }
  double position(uint32_t step_pin, int64_t net) const;
  // Moves the actuator, as if by hand.
  void place(uint32_t step_pin, int64_t net, double position);
  // The board was reset: step counts start at 0 again, the actuators keep their positions.
  void rebase(uint32_t step_pin, int64_t net);

  // Fixed time steps: the result does not depend on the times of the calls.
  void run_until(Ticks clock);

 private:
  static constexpr double kStepSeconds = 0.02;
  static constexpr double kServoCycleUs = 20000;
  double hz_;
  Ticks next_look_ = kNever;
  double step_s_;
  Ticks step_ticks_;
  uint32_t adc_max_;
  Ticks done_;
  uint32_t random_ = 1;

  // -1…1, the same on every computer: a linear congruential generator (Numerical Recipes).
  double random();
};

}  // namespace passo::wire
