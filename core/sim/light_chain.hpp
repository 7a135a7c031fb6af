// A simulated chain of lights on a data pin, perhaps with a clock: what it shows.
#pragma once
#include <cstdint>
#include <utility>
#include <vector>

#include "link/device.hpp"

namespace passo::wire {

struct LightChain {
  uint32_t pin = 0;
  int64_t clock_pin = -1;  // -1: frames come as a whole
  size_t clocked = 0;      // LEDs of a chain with a clock, 4 bytes each
  Bytes shown;
  bool tracing = false;
  std::vector<std::pair<Ticks, Bytes>> frames;  // while tracing
  uint32_t failures = 0;                        // a fault: the next frames that are late

  // False if the frame was late: then it shows no change.
  bool show(const Bytes& data, Ticks clock) {
    if (failures > 0) {
      --failures;
      return false;
    }
    shown = data;
    if (tracing) frames.emplace_back(clock, data);
    return true;
  }

  // A chain with a clock takes bits at rising edges. After four bytes of 0, each LED takes four
  // bytes, of which the first begins with three bits of 1.
  void edge(uint32_t changed, bool level, Ticks clock) {
    if (clock_pin < 0) return;
    if (changed == pin) data_level_ = level;
    if (changed != uint32_t(clock_pin) || !level) return;
    byte_ = uint8_t(byte_ << 1 | data_level_);
    if (++bits_ < 8) return;
    bits_ = 0;
    take(byte_, clock);
  }
  void take(uint8_t byte, Ticks clock) {
    zeros_ = byte == 0 ? zeros_ + 1 : 0;
    if (frame_.empty() && !open_) {
      open_ = zeros_ >= 4;
      return;
    }
    frame_.push_back(byte);
    if (frame_.size() < 4 * clocked) return;
    show(frame_, clock);
    frame_.clear();
    open_ = false;
    zeros_ = 0;
  }

 private:
  bool data_level_ = false, open_ = false;
  uint8_t byte_ = 0;
  int bits_ = 0, zeros_ = 0;
  Bytes frame_;
};

// A simulated chip that sets LEDs over I2C: its registers. The first byte that is written selects
// one, with 0x80 the later bytes belong to those after it.
struct LedChip {
  Bytes registers = Bytes(16);

  bool begin() {
    selects_ = true;
    return true;
  }
  bool take(uint8_t byte) {
    if (selects_) {
      at_ = byte & 0x0f;
      steps_ = byte & 0x80;
      selects_ = false;
      return true;
    }
    registers[at_] = byte;
    if (steps_) at_ = (at_ + 1) % registers.size();
    return true;
  }

 private:
  bool selects_ = true, steps_ = false;
  size_t at_ = 0;
};

}  // namespace passo::wire
