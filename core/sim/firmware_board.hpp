// A board whose firmware is Passo's own, as a library in this process, in virtual time.
#pragma once
#include <dlfcn.h>
#include <stdlib.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <mutex>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "host.h"
#include "sim/simulated_device.hpp"

namespace passo::wire {

// A copy of the firmware library for one board: its state is that of the copy. Copies that are
// given back wait for the next board, which powers them on anew.
class FirmwareLibrary {
 public:
  // Throws std::runtime_error if it cannot be loaded.
  explicit FirmwareLibrary(const std::string& path) : path_(path) {
    {
      std::lock_guard lock(mutex());
      auto& waiting = idle()[path];
      if (!waiting.empty()) {
        functions_ = waiting.back();
        waiting.pop_back();
        return;
      }
    }
    functions_ = load(path);
  }
  ~FirmwareLibrary() {
    std::lock_guard lock(mutex());
    idle()[path_].push_back(functions_);
  }
  FirmwareLibrary(const FirmwareLibrary&) = delete;
  FirmwareLibrary& operator=(const FirmwareLibrary&) = delete;

  const host_functions* operator->() const { return functions_; }

 private:
  std::string path_;
  const host_functions* functions_;

  static std::mutex& mutex() {
    static auto* mutex = new std::mutex;  // boards may outlive what is destroyed at exit
    return *mutex;
  }
  static std::map<std::string, std::vector<const host_functions*>>& idle() {
    static auto* idle = new std::map<std::string, std::vector<const host_functions*>>;
    return *idle;
  }
  // The loader knows a file by its place on the disk, so that each copy needs a file of its own.
  static const host_functions* load(const std::string& path) {
    std::string copy = (std::filesystem::temp_directory_path() / "passo-firmware-XXXXXX").string();
    int file = mkstemp(copy.data());
    if (file < 0) throw std::runtime_error("no temporary file for the firmware's library");
    close(file);
    bool copied = bool(std::ofstream(copy, std::ios::binary)
                       << std::ifstream(path, std::ios::binary).rdbuf());
    void* handle = copied ? dlopen(copy.c_str(), RTLD_NOW | RTLD_LOCAL) : nullptr;
    unlink(copy.c_str());
    void* symbol = handle ? dlsym(handle, "passo_firmware") : nullptr;
    if (symbol) return reinterpret_cast<decltype(&passo_firmware)>(symbol)();
    if (handle) dlclose(handle);
    throw std::runtime_error("'" + path + "' is no firmware library");
  }
};

class FirmwareBoard : public Bench {
 public:
  struct Options {
    uint32_t clock_hz = 16000000;
    uint16_t move_count = 1024;
    uint32_t adc_max = 1023;
    Bytes identify;                     // zlib-compressed dictionary
    Ticks start = 0;                    // clock at power-on
    std::map<int, std::string> faults;  // the dictionary's reasons by their numbers
  };

  FirmwareBoard(const std::string& library, Options options)
      : Bench(options.clock_hz, options.adc_max, options.start), options_(std::move(options)),
        firmware_(library) {
    host_options host{options_.clock_hz, options_.move_count, options_.identify.data(),
                      uint16_t(options_.identify.size()), options_.start};
    host_surroundings surroundings{this, on_edge, on_output, on_level, on_analog};
    firmware_->start(&host, &surroundings);
  }

  // A motor driver on these pins; to be told before the board moves it.
  void add_motor(uint32_t step_pin, uint32_t dir_pin, bool step_inverted) {
    if (step_pin >= motor_of_.size()) motor_of_.resize(step_pin + 1, -1);
    motor_of_[step_pin] = int(motors_.size());
    motors_.push_back({step_pin, dir_pin, step_inverted});
  }

  void feed(const uint8_t* data, size_t n, Ticks now) override {
    firmware_->feed(data, n, now);
    now_ = std::max(now_, now);
  }
  void poll(Ticks now, Bytes& out) override {
    firmware_->run(now);
    now_ = std::max(now_, now);
    size_t size;
    const uint8_t* said = firmware_->take(&size);
    out.insert(out.end(), said, said + size);
  }
  Ticks next_deadline() const override { return firmware_->next(); }
  bool stopped() const override { return firmware_->state().reason != 0; }
  std::string fault() const override {
    uint8_t reason = firmware_->state().reason;
    return reason == 0 ? "" : options_.faults.at(reason);
  }
  uint64_t frames() const override { return firmware_->state().frames; }
  uint64_t naks() const override { return firmware_->state().naks; }

  int64_t net_steps(uint32_t step_pin) override { return motor(step_pin).net; }
  int64_t steps(uint32_t step_pin) override { return motor(step_pin).steps; }
  void trace_steps(uint32_t step_pin, Ticks from, Ticks to) override {
    motor(step_pin).from = from;
    motor(step_pin).to = to;
  }
  std::vector<StepRun> take_steps(uint32_t step_pin) override {
    return std::exchange(motor(step_pin).trace, {});
  }
  uint32_t output_value(uint32_t pin) override { return output(pin).value; }
  void trace_output(uint32_t pin) override { output(pin).tracing = true; }
  std::vector<PinChange> take_changes(uint32_t pin) override {
    return std::exchange(output(pin).trace, {});
  }
  // From now on keeps all edges of a pin, for take_edges().
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
  };
  struct Output {
    uint32_t value = 0;
    bool tracing = false;
    std::vector<PinChange> trace;
  };

  const Options options_;
  FirmwareLibrary firmware_;
  std::vector<Motor> motors_;
  std::vector<int> motor_of_;  // by step pin; -1: none
  std::map<uint32_t, Output> outputs_;
  std::map<uint32_t, std::vector<PinChange>> edges_;

  Motor& motor(uint32_t step_pin) {
    int index = step_pin < motor_of_.size() ? motor_of_[step_pin] : -1;
    if (index < 0) throw UnknownPin("no stepper on this pin");
    return motors_[size_t(index)];
  }
  Output& output(uint32_t pin) {
    auto it = outputs_.find(pin);
    if (it == outputs_.end()) throw UnknownPin("no output is configured on this pin");
    return it->second;
  }
  int64_t net(uint32_t step_pin) override { return motor(step_pin).net; }

  static FirmwareBoard& self(void* owner) { return *static_cast<FirmwareBoard*>(owner); }
  static void on_edge(void* owner, uint16_t pin, bool level, int64_t clock) {
    self(owner).edge(pin, level, clock);
  }
  void edge(uint32_t pin, bool level, Ticks clock) {
    if (!edges_.empty())
      if (auto it = edges_.find(pin); it != edges_.end()) it->second.push_back({clock, level});
    int index = pin < motor_of_.size() ? motor_of_[pin] : -1;
    if (index >= 0) {
      Motor& m = motors_[size_t(index)];
      if (level != m.step_inverted) step(m, clock);
      return;
    }
    for (Motor& m : motors_)
      if (m.dir_pin == pin) m.forward = level;
    plant_.edge(pin, level, clock);
  }
  static void step(Motor& m, Ticks clock) {
    int8_t dir = m.forward ? 1 : -1;
    m.net += dir;
    ++m.steps;
    if (clock >= m.from && clock < m.to) m.trace.push_back({clock - 1, clock, 1, 1, 0, dir});
  }
  static void on_output(void* owner, uint16_t pin, uint32_t value, uint32_t full, int64_t clock) {
    FirmwareBoard& board = self(owner);
    Output& output = board.outputs_[pin];
    if (output.tracing && value != output.value) output.trace.push_back({clock, value});
    output.value = value;
    board.plant_.set_output(pin, clock, double(value) / full);
  }
  static bool on_level(void* owner, uint16_t pin, int64_t clock) {
    return self(owner).level(pin, clock);
  }
  static uint16_t on_analog(void* owner, uint16_t pin, int64_t clock) {
    return uint16_t(self(owner).plant_.adc(pin, clock));
  }
};

}  // namespace passo::wire
