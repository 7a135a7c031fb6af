#include "sim/plant.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace passo::wire {

void Plant::add_body(HeatedBody body) {
  body.body_c = body.sensor_c = body.ambient_c;
  body.heat.since = body.fan.since = done_;
  bodies.push_back(std::move(body));
}

void Plant::add_probe(BedProbe probe) {
  probe.mechanism.hz = hz_;
  if (probe.mechanism.kind == ProbeMechanism::Kind::dock) next_look_ = next_dock_ = done_;
  probes.push_back(std::move(probe));
}

void Plant::add_stall_sensor(std::shared_ptr<StallSensor> sensor) {
  next_look_ = next_load_ = done_;
  const Actuator* driven = actuator(sensor->step_pin());
  loads_.push_back({std::move(sensor), driven ? driven->start : 0.0});
}

void Plant::add_rotor(FanRotor rotor) {
  rotor.since = done_;
  rotors.push_back(rotor);
}

void Plant::clock_lights(uint32_t data_pin, uint32_t clock_pin, const Bytes& data, Ticks clock) {
  for (LightChain& chain : lights)
    if (chain.pin == data_pin && chain.clock_pin == int64_t(clock_pin))
      for (uint8_t byte : data) chain.take(byte, clock);
}

bool Plant::show_lights(uint32_t pin, const Bytes& data, Ticks clock) {
  for (LightChain& chain : lights)
    if (chain.pin == pin) return chain.show(data, clock);
  return true;
}

void Plant::set_output(uint32_t pin, Ticks clock, double duty) {
  if (std::find(low_is_on.begin(), low_is_on.end(), pin) != low_is_on.end()) duty = 1 - duty;
  for (BedProbe& probe : probes)
    if (probe.mechanism.control_pin == pin && duty > 0)
      probe.mechanism.pulse(duty * kServoCycleUs, clock);
  for (FanRotor& rotor : rotors) {
    if (rotor.fan_pin != pin) continue;
    run_until(clock);
    rotor.duty = duty;
  }
  for (HeatedBody& body : bodies) {
    bool fan = body.fan_loss > 0 && body.fan_pin == pin;
    if (body.heater_pin != pin && !fan) continue;
    run_until(clock);
    (fan ? body.fan : body.heat).set(duty, clock);
  }
}

double Plant::share(uint32_t pin, Ticks clock) {
  for (HeatedBody& body : bodies) {
    if (body.sensor_pin != pin) continue;
    run_until(clock);
    double ratio = body.forced_ratio >= 0 ? body.forced_ratio : body.adc_ratio.at(body.sensor_c);
    if (body.noise > 0) ratio = std::clamp(ratio + body.noise * random(), 0.0, 1.0);
    return ratio;
  }
  return 1;
}

void Plant::edge(uint32_t pin, bool level, Ticks clock) {
  for (UartLine& line : uarts)
    if (line.tx_pin() == pin) line.edge(level, clock);
  for (SpiDevice& device : spi_devices) device.edge(pin, level, clock);
  for (I2cDevice& device : i2c_devices) device.edge(pin, level, clock);
  for (LightChain& chain : lights) chain.edge(pin, level, clock);
}

UartLine* Plant::uart(uint32_t rx_pin) {
  for (UartLine& line : uarts)
    if (line.rx_pin() == rx_pin) return &line;
  return nullptr;
}

SpiDevice* Plant::spi_device(uint32_t select_pin) {
  for (SpiDevice& device : spi_devices)
    if (device.pins().select == select_pin) return &device;
  return nullptr;
}

I2cDevice* Plant::i2c_device(I2cPins pins, uint8_t address) {
  for (I2cDevice& device : i2c_devices)
    if (device.pins() == pins && device.address() == address) return &device;
  return nullptr;
}

double Plant::position(uint32_t step_pin, int64_t net) const {
  for (const Actuator& a : actuators)
    if (a.step_pin == step_pin) return a.start + double(net) * a.per_step;
  return 0;
}

void Plant::place(uint32_t step_pin, int64_t net, double position) {
  if (Actuator* a = actuator(step_pin)) a->start = position - double(net) * a->per_step;
}

void Plant::rebase(uint32_t step_pin, int64_t net) {
  if (Actuator* a = actuator(step_pin)) a->start += double(net) * a->per_step;
}

void Plant::run_until(Ticks clock) {
  for (; done_ + step_ticks_ <= clock; done_ += step_ticks_) {
    for (FanRotor& rotor : rotors) rotor.step(step_s_, step_ticks_);
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

double Plant::random() {
  random_ = random_ * 1664525u + 1013904223u;
  return double(random_) / 2147483648.0 - 1;
}

void Plant::look(Ticks clock, const Position& position) {
  if (clock >= next_dock_) {
    next_dock_ = clock + Ticks(ProbeMechanism::kSampleSeconds * hz_);
    look_at_docks(position);
  }
  if (clock >= next_load_) {
    next_load_ = clock + Ticks(StallSensor::kSampleSeconds * hz_);
    look_at_loads(position);
  }
  next_look_ = std::min(next_dock_, next_load_);
}

void Plant::look_at_docks(const Position& position) {
  for (BedProbe& probe : probes) {
    if (probe.mechanism.kind != ProbeMechanism::Kind::dock) continue;
    std::vector<double> q;
    for (uint32_t step_pin : probe.motors) q.push_back(position(step_pin));
    double p[3];
    if (probe.nozzle(q.data(), p)) probe.mechanism.look(p);
  }
}

Actuator* Plant::actuator(uint32_t step_pin) {
  for (Actuator& a : actuators)
    if (a.step_pin == step_pin) return &a;
  return nullptr;
}

void Plant::look_at_loads(const Position& position) {
  for (Motor& motor : loads_) {
    motor.moved = position(motor.sensor->step_pin()) - motor.position;
    motor.blocked = false;
  }
  for (const TravelStop& stop : stops) {
    double at = 0, square = 0;
    for (auto [step_pin, weight] : stop.weights) {
      at += weight * position(step_pin);
      square += weight * weight;
    }
    const double beyond = at - stop.position;
    if (stop.at_maximum ? beyond <= 0 : beyond >= 0) continue;
    for (auto [step_pin, weight] : stop.weights) {
      if (Actuator* pushed = actuator(step_pin)) pushed->start -= beyond * weight / square;
      for (Motor& motor : loads_) motor.blocked |= motor.sensor->step_pin() == step_pin;
    }
  }
  for (Motor& motor : loads_) {
    const Actuator* driven = actuator(motor.sensor->step_pin());
    motor.sensor->look(driven ? motor.moved / driven->per_step : 0.0, motor.blocked);
    motor.position = position(motor.sensor->step_pin());
  }
}

bool Plant::level(uint32_t pin, Ticks clock, const Position& position) {
  if (UartLine* line = uart(pin)) return line->level(clock);
  for (const SpiDevice& device : spi_devices)
    if (device.drives(pin)) return device.level();
  for (const I2cDevice& device : i2c_devices)
    if (device.pins().data == pin && device.pulls()) return false;
  for (const Motor& motor : loads_)
    if (motor.sensor->diag_pin() == pin) return motor.sensor->level();
  for (const Switch& s : switches) {
    if (s.pin != pin) continue;
    double at = 0;
    for (auto [step_pin, weight] : s.weights) at += weight * position(step_pin);
    bool pressed = s.at_maximum ? at >= s.position : at <= s.position;
    if (s.edge_mm > 0) pressed = std::fmod(std::floor(at / s.edge_mm), 2) != 0;
    if (s.forced >= 0) pressed = s.forced > 0;
    if (s.forced == 2) pressed = clock / Ticks(Switch::kFlickerSeconds * hz_) % 2 != 0;
    return pressed == s.pressed_level;
  }
  for (const FanRotor& rotor : rotors) {
    if (rotor.tacho_pin != pin) continue;
    run_until(clock);
    return rotor.level(clock, hz_);
  }
  for (BedProbe& probe : probes) {
    if (probe.pin != pin) continue;
    const std::vector<double> q = felt_by(probe, position);
    return probe.triggered(q.data(), clock) == probe.pressed_level;
  }
  return true;  // an input that is not connected: the pull-up wins
}

double Plant::gap(uint32_t probe_pin, const Position& position) {
  for (BedProbe& probe : probes)
    if (probe.pin == probe_pin) return probe.gap(felt_by(probe, position).data());
  return std::numeric_limits<double>::infinity();
}

std::vector<double> Plant::felt_by(BedProbe& probe, const Position& position) {
  std::vector<double> q;
  for (uint32_t step_pin : probe.motors) q.push_back(position(step_pin));
  for (Lift& lift : probe.lifts) lift.position = position(lift.motor);
  return q;
}

}  // namespace passo::wire
