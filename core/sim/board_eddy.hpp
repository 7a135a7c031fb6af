// Eddy current sensors of the virtual board, and the trigger that stops motors at one of their
// values.
#pragma once
#include <cstdint>

#include "link/device.hpp"

namespace passo::wire {

// An LDC1612 on an I2C bus. The board looks every `rest` ticks whether it has a new value, and
// reports the values in blocks. A value that the board could not read is 0xffff00 and its error.
struct BoardEddy {
  static constexpr size_t kSampleBytes = 4, kBlockBytes = 48;
  enum Error : uint8_t { kSensor, kStatus, kData, kInvalid };
  uint32_t i2c_oid;
  int64_t trigger_oid = -1;
  Ticks begin = kNever, rest = 0;
  uint16_t sequence = 0;
  Bytes data;

  explicit BoardEddy(uint32_t i2c) : i2c_oid(i2c) {}
  Ticks next() const { return begin; }
};

// A filter without sections: (value + offset) * scale. As in the real firmware, the scale is 0
// until it is set.
struct BoardFilter {
  int32_t offset = 0;
  int64_t scale = 0;
  uint32_t fraction_bits = 0;

  static Ticks next() { return kNever; }
  int32_t apply(int32_t value) const {
    return int32_t(scale * (int64_t(value) + offset) >> fraction_bits);
  }
};

// Triggers a trsync once a filtered value is greater than `threshold`. A value outside of the raw
// range, an error of the sensor, or no value for more than `patience` checks triggers it with an
// error.
struct BoardTrigger {
  static constexpr uint32_t kRange = 0, kOverflow = 1, kSilent = 2, kSensor = 3;  // errors
  static constexpr uint32_t kGreater = 1;                                         // type of trigger
  uint32_t filter_oid;
  int32_t minimum = 0, maximum = 0, threshold = 0;
  uint32_t type = 0, trsync = 0, reason = 0, error_reason = 0;
  bool armed = false;
  Ticks from = 0, due = kNever, every = 0;
  uint32_t patience = 0, silent = 0;

  explicit BoardTrigger(uint32_t filter) : filter_oid(filter) {}
  Ticks next() const { return due; }
  void disarm() {
    armed = false;
    due = kNever;
  }
  // The periodic check. Returns whether there was no value for too long.
  bool watch() {
    if (silent > patience) return true;
    ++silent;
    due += every;
    return false;
  }
};

}  // namespace passo::wire
