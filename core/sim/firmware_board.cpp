#include "sim/firmware_board.hpp"

#include <dlfcn.h>
#include <stdlib.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <stdexcept>

#include "host.h"

namespace passo::wire {

namespace {

std::mutex& mutex() {
  static auto* mutex =
      new std::mutex;  // never destroyed: boards may live longer than static objects
  return *mutex;
}

std::map<std::string, std::vector<const host_functions*>>& idle() {
  static auto* idle = new std::map<std::string, std::vector<const host_functions*>>;
  return *idle;
}

// The loader identifies a library by its file, so each copy of the firmware needs a file of its
// own.
const host_functions* load(const std::string& path) {
  std::string copy = (std::filesystem::temp_directory_path() / "passo-firmware-XXXXXX").string();
  int file = mkstemp(copy.data());
  if (file < 0) throw std::runtime_error("no temporary file for the firmware's library");
  close(file);
  bool copied =
      bool(std::ofstream(copy, std::ios::binary) << std::ifstream(path, std::ios::binary).rdbuf());
  void* handle = copied ? dlopen(copy.c_str(), RTLD_NOW | RTLD_LOCAL) : nullptr;
  unlink(copy.c_str());
  void* symbol = handle ? dlsym(handle, "passo_firmware") : nullptr;
  if (symbol) return reinterpret_cast<decltype(&passo_firmware)>(symbol)();
  if (handle) dlclose(handle);
  throw std::runtime_error("'" + path + "' is no firmware library");
}

}  // namespace

FirmwareLibrary::FirmwareLibrary(const std::string& path) : path_(path) {
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

FirmwareLibrary::~FirmwareLibrary() {
  std::lock_guard lock(mutex());
  idle()[path_].push_back(functions_);
}

Bytes built_dictionary(const std::string& library) {
  FirmwareLibrary firmware(library);
  size_t size;
  const uint8_t* data = firmware->built_dictionary(&size);
  return Bytes(data, data + size);
}

FirmwareBoard::FirmwareBoard(const std::string& library, Options options)
    : Bench(options.clock_hz, options.adc_max, options.start), options_(std::move(options)),
      firmware_(library) {
  host_options host{options_.clock_hz, options_.move_count, options_.identify.data(),
                    uint16_t(options_.identify.size()), options_.start};
  host_surroundings surroundings{this, on_edge, on_output, on_level, on_analog, on_lights};
  firmware_->start(&host, &surroundings);
}

void FirmwareBoard::add_motor(uint32_t step_pin, uint32_t dir_pin, bool step_inverted) {
  if (step_pin >= motor_of_.size()) motor_of_.resize(step_pin + 1, -1);
  motor_of_[step_pin] = int(motors_.size());
  Motor motor;
  motor.step_pin = step_pin;
  motor.dir_pin = dir_pin;
  motor.step_inverted = step_inverted;
  motors_.push_back(std::move(motor));
}

void FirmwareBoard::feed(const uint8_t* data, size_t n, Ticks now) {
  firmware_->feed(data, n, now);
  now_ = std::max(now_, now);
}

void FirmwareBoard::poll(Ticks now, Bytes& out) {
  firmware_->run(now);
  now_ = std::max(now_, now);
  look();
  size_t size;
  const uint8_t* sent = firmware_->take(&size);
  out.insert(out.end(), sent, sent + size);
}

Ticks FirmwareBoard::next_deadline() const {
  return std::min(firmware_->next(), plant_.next_look());
}

bool FirmwareBoard::stopped() const { return firmware_->state().reason != 0; }

uint64_t FirmwareBoard::frames() const { return firmware_->state().frames; }

uint64_t FirmwareBoard::naks() const { return firmware_->state().naks; }

std::string FirmwareBoard::fault() const {
  uint8_t reason = firmware_->state().reason;
  return reason == 0 ? "" : options_.faults.at(reason);
}

void FirmwareBoard::trace_steps(uint32_t step_pin, Ticks from, Ticks to) {
  motor(step_pin).from = from;
  motor(step_pin).to = to;
}

std::vector<StepRun> FirmwareBoard::take_steps(uint32_t step_pin) {
  return std::exchange(motor(step_pin).trace, {});
}

void FirmwareBoard::follow_steps(uint32_t step_pin, bool on) {
  Motor& m = motor(step_pin);
  m.following = on;
  m.followed.clear();
}

// The firmware has not executed later steps, so the clock is not needed.
std::vector<StepRun> FirmwareBoard::take_followed(uint32_t step_pin, Ticks) {
  return std::exchange(motor(step_pin).followed, {});
}

std::vector<PinChange> FirmwareBoard::take_changes(uint32_t pin) {
  return std::exchange(output(pin).trace, {});
}

FirmwareBoard::Motor& FirmwareBoard::motor(uint32_t step_pin) {
  int index = step_pin < motor_of_.size() ? motor_of_[step_pin] : -1;
  if (index < 0) throw UnknownPin("no stepper on this pin");
  return motors_[size_t(index)];
}

FirmwareBoard::Output& FirmwareBoard::output(uint32_t pin) {
  auto it = outputs_.find(pin);
  if (it == outputs_.end()) throw UnknownPin("no output is configured on this pin");
  return it->second;
}

void FirmwareBoard::on_edge(void* owner, uint16_t pin, bool level, int64_t clock) {
  self(owner).edge(pin, level, clock);
}

void FirmwareBoard::edge(uint32_t pin, bool level, Ticks clock) {
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

void FirmwareBoard::step(Motor& m, Ticks clock) {
  int8_t dir = m.forward ? 1 : -1;
  m.net += dir;
  ++m.steps;
  const StepRun run{clock - 1, clock, 1, 1, 0, dir};
  if (clock >= m.from && clock < m.to) m.trace.push_back(run);
  if (m.following) m.followed.push_back(run);
}

void FirmwareBoard::on_output(void* owner, uint16_t pin, uint32_t value, uint32_t full,
                              int64_t clock) {
  FirmwareBoard& board = self(owner);
  Output& output = board.outputs_[pin];
  if (output.tracing && value != output.value) output.trace.push_back({clock, value});
  output.value = value;
  board.plant_.set_output(pin, clock, double(value) / full);
}

bool FirmwareBoard::on_level(void* owner, uint16_t pin, int64_t clock) {
  return self(owner).level(pin, clock);
}

uint16_t FirmwareBoard::on_analog(void* owner, uint16_t pin, int64_t clock) {
  return uint16_t(self(owner).plant_.adc(pin, clock));
}

bool FirmwareBoard::on_lights(void* owner, uint16_t pin, const uint8_t* data, uint16_t size,
                              int64_t clock) {
  return self(owner).plant_.show_lights(pin, Bytes(data, data + size), clock);
}

}  // namespace passo::wire
