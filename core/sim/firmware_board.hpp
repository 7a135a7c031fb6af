// A board that runs Passo's own firmware, as a library in this process, in virtual time.
#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "sim/simulated_device.hpp"

struct host_functions;  // firmware/hal/host/host.h

namespace passo::wire {

// A copy of the firmware library with its own state, for one board. When a board is destroyed, the
// next board uses the copy again and powers it on again.
class FirmwareLibrary {
 public:
  // Throws std::runtime_error if the library cannot be loaded.
  explicit FirmwareLibrary(const std::string& path);
  ~FirmwareLibrary();
  FirmwareLibrary(const FirmwareLibrary&) = delete;
  FirmwareLibrary& operator=(const FirmwareLibrary&) = delete;

  const host_functions* operator->() const { return functions_; }

 private:
  std::string path_;
  const host_functions* functions_;
};

// The dictionary in a firmware library, compressed.
Bytes built_dictionary(const std::string& library);

class FirmwareBoard : public Bench {
 public:
  struct Options {
    uint32_t clock_hz = 16000000;
    uint16_t move_count = 1024;
    uint32_t adc_max = 1023;
    Bytes identify;                     // zlib-compressed dictionary
    Ticks start = 0;                    // clock at power-on
    std::map<int, std::string> faults;  // texts of the shutdown reasons, by number
  };

  FirmwareBoard(const std::string& library, Options options);

  // Connects a motor driver to these pins. Call this before the board moves the motor.
  void add_motor(uint32_t step_pin, uint32_t dir_pin, bool step_inverted);

  void feed(const uint8_t* data, size_t n, Ticks now) override;
  void poll(Ticks now, Bytes& out) override;
  Ticks next_deadline() const override;
  bool stopped() const override;
  std::string fault() const override;
  uint64_t frames() const override;
  uint64_t naks() const override;

  int64_t net_steps(uint32_t step_pin) override { return motor(step_pin).net; }
  int64_t steps(uint32_t step_pin) override { return motor(step_pin).steps; }
  void trace_steps(uint32_t step_pin, Ticks from, Ticks to) override;
  std::vector<StepRun> take_steps(uint32_t step_pin) override;
  void follow_steps(uint32_t step_pin, bool on) override;
  std::vector<StepRun> take_followed(uint32_t step_pin, Ticks until) override;
  uint32_t output_value(uint32_t pin) override { return output(pin).value; }
  void trace_output(uint32_t pin) override { output(pin).tracing = true; }
  std::vector<PinChange> take_changes(uint32_t pin) override;
  // From now on keeps all edges of a pin for take_edges().
  void trace_edges(uint32_t pin) { edges_[pin]; }
  std::vector<PinChange> take_edges(uint32_t pin) { return std::exchange(edges_[pin], {}); }

 private:
  struct Motor {
    uint32_t step_pin, dir_pin;
    bool step_inverted;
    bool forward = false;
    int64_t net = 0, steps = 0;
    Ticks from = kNever, to = kNever;
    std::vector<StepRun> trace;
    bool following = false;
    std::vector<StepRun> followed;
  };
  struct Output {
    uint32_t value = 0;
    bool tracing = false;
    std::vector<PinChange> trace;
  };

  const Options options_;
  FirmwareLibrary firmware_;
  std::vector<Motor> motors_;
  std::vector<int> motor_of_;  // by step pin; -1: no motor
  std::map<uint32_t, Output> outputs_;
  std::map<uint32_t, std::vector<PinChange>> edges_;

  Motor& motor(uint32_t step_pin);
  Output& output(uint32_t pin);
  int64_t net(uint32_t step_pin) override { return motor(step_pin).net; }

  static FirmwareBoard& self(void* owner) { return *static_cast<FirmwareBoard*>(owner); }
  static void on_edge(void* owner, uint16_t pin, bool level, int64_t clock);
  void edge(uint32_t pin, bool level, Ticks clock);
  static void step(Motor& m, Ticks clock);
  static void on_output(void* owner, uint16_t pin, uint32_t value, uint32_t full, int64_t clock);
  static bool on_level(void* owner, uint16_t pin, int64_t clock);
  static uint16_t on_analog(void* owner, uint16_t pin, int64_t clock);
  static bool on_lights(void* owner, uint16_t pin, const uint8_t* data, uint16_t size,
                        int64_t clock);
};

}  // namespace passo::wire
