// The simulated printer around the virtual board. Motors move actuators, actuators trigger
// endstops, heaters heat bodies, and sensors measure them. As with real parts, the interface is
// pins and clocks.
#pragma once
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "heat/curve.hpp"
#include "link/device.hpp"
#include "sim/bed.hpp"
#include "sim/fan_rotor.hpp"
#include "sim/i2c_device.hpp"
#include "sim/light_chain.hpp"
#include "sim/spi_device.hpp"
#include "sim/stall_sensor.hpp"
#include "sim/uart_line.hpp"

namespace passo::wire {

// The actuator of one motor: position = start + net steps * per_step, in mm or degrees. per_step is
// negative if the direction pin of the motor is inverted.
struct Actuator {
  uint32_t step_pin;
  double start, per_step;
};

// An endstop that is triggered when a combined position is at `position` or beyond it, towards the
// end of the travel. The combined position is the weighted sum of actuator positions.
struct Switch {
  uint32_t pin;
  std::vector<std::pair<uint32_t, double>> weights;  // step pin, weight
  double position;
  bool at_maximum;
  bool pressed_level;
  int forced = -1;  // a fault: 0 is never triggered, 1 always, 2 changes every kFlickerSeconds
  // If not 0, this is the wheel of a filament sensor: its level changes each time the combined
  // position has moved by this length.
  double edge_mm = 0;

  static constexpr double kFlickerSeconds = 0.005;
};

// A heated body and its sensor, both first-order. Without a fan the body approaches ambient + rise
// * duty. With a fan it loses (1 + fan_loss * duty of the fan) times as much heat.
struct HeatedBody {
  uint32_t heater_pin, sensor_pin;
  double ambient_c, rise_c, time_constant_s, sensor_time_constant_s;
  heat::Curve adc_ratio;  // °C → fraction of the ADC's full scale
  uint32_t fan_pin = 0;   // unused if fan_loss is 0
  double fan_loss = 0;
  double body_c = 0, sensor_c = 0;

  // The mean duty of a pin during a simulation step.
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

  // Faults: a fixed ratio at the ADC, or a fixed duty of the heater, if not negative; noise of the
  // ADC as a fraction of full scale; a sensor that has fallen off.
  double forced_ratio = -1, forced_duty = -1, noise = 0;
  bool fallen = false;
};

class Plant {
 public:
  std::vector<Actuator> actuators;
  std::vector<Switch> switches;
  std::vector<BedProbe> probes;
  std::vector<HeatedBody> bodies;
  std::vector<uint32_t> low_is_on;  // output pins that are on at low level
  std::deque<UartLine> uarts;
  std::deque<SpiDevice> spi_devices;
  std::deque<I2cDevice> i2c_devices;
  std::vector<TravelStop> stops;
  std::vector<FanRotor> rotors;
  std::vector<LightChain> lights;

  Plant(double clock_hz, uint32_t adc_max, Ticks start)
      : hz_(clock_hz), step_s_(kStepSeconds), step_ticks_(Ticks(kStepSeconds * clock_hz)),
        adc_max_(adc_max), done_(start) {}

  void add_body(HeatedBody body);
  void add_probe(BedProbe probe);
  void add_stall_sensor(std::shared_ptr<StallSensor> sensor);
  void add_rotor(FanRotor rotor);

  // From `clock` on, an output pin is high for the fraction `duty` of the time.
  void set_output(uint32_t pin, Ticks clock, double duty);
  // The reading of the sensor on a pin, as a fraction of full scale; 1 without a sensor.
  double share(uint32_t pin, Ticks clock);
  uint32_t adc(uint32_t pin, Ticks clock) { return uint32_t(share(pin, clock) * adc_max_ + 0.5); }
  // An edge on a pin of a UART, SPI or I2C bus.
  void edge(uint32_t pin, bool level, Ticks clock);
  // A chain with a clock receives bytes from a bus of these pins.
  void clock_lights(uint32_t data_pin, uint32_t clock_pin, const Bytes& data, Ticks clock);
  // A chain of lights receives a frame; false if it was late.
  bool show_lights(uint32_t pin, const Bytes& data, Ticks clock);
  UartLine* uart(uint32_t rx_pin);
  SpiDevice* spi_device(uint32_t select_pin);
  I2cDevice* i2c_device(I2cPins pins, uint8_t address);
  using Position = std::function<double(uint32_t step_pin)>;
  // The level of an input pin. position(step_pin) returns an actuator position.
  bool level(uint32_t pin, Ticks clock, const Position& position);
  // The height of the nozzle above the bed at the place of the probe on this pin, mm; infinite
  // without a probe on it, or if the machine cannot be there.
  double gap(uint32_t probe_pin, const Position& position);
  // Parts that detect the position of the head take a sample. next_look(): clock of the next
  // sample.
  void look(Ticks clock, const Position& position);
  Ticks next_look() const { return next_look_; }
  double position(uint32_t step_pin, int64_t net) const;
  // Moves the actuator, as if by hand.
  void place(uint32_t step_pin, int64_t net, double position);
  // The board was reset, so that its step counts restart at 0. The actuators keep their positions.
  void rebase(uint32_t step_pin, int64_t net);

  // Simulates in fixed time steps, so that the result does not depend on when it is called.
  void run_until(Ticks clock);

 private:
  static constexpr double kStepSeconds = 0.02;
  static constexpr double kServoCycleUs = 20000;
  struct Motor {
    std::shared_ptr<StallSensor> sensor;
    double position;  // of its actuator, at the last sample
    double moved = 0;
    bool blocked = false;
  };
  double hz_;
  Ticks next_look_ = kNever, next_load_ = kNever, next_dock_ = kNever;
  std::vector<Motor> loads_;
  double step_s_;
  Ticks step_ticks_;
  uint32_t adc_max_;
  Ticks done_;
  uint32_t random_ = 1;

  Actuator* actuator(uint32_t step_pin);
  // The positions of the motors of a probe.
  static std::vector<double> felt_by(BedProbe& probe, const Position& position);
  void look_at_docks(const Position& position);
  void look_at_loads(const Position& position);
  // A random number from -1 to 1, the same on every computer: linear congruential generator
  // (Numerical Recipes).
  double random();
};

}  // namespace passo::wire
