// A simulated device on an I2C bus, as levels of its two lines.
#pragma once
#include <cstdint>
#include <functional>
#include <utility>

#include "link/device.hpp"

namespace passo::wire {

struct I2cPins {
  uint32_t clock, data;
  bool operator==(const I2cPins&) const = default;
};

// How a transfer ended, in the numbers of the enumeration `i2c_bus_status`.
enum class I2cStatus : uint8_t { success, nack, bus_timeout, start_nack, start_read_nack };

// The chip on the bus, byte by byte. `begin`: it was addressed, to be written or read; `take`: it
// gets a byte. Both return whether it acknowledges. `give`: it is read.
struct I2cChip {
  std::function<bool(bool reads)> begin;
  std::function<bool(uint8_t byte, Ticks)> take;
  std::function<uint8_t(Ticks)> give;
};

class I2cDevice {
 public:
  I2cDevice(I2cPins pins, uint8_t address, I2cChip chip)
      : pins_(pins), address_(address), chip_(std::move(chip)) {}

  const I2cPins& pins() const { return pins_; }
  uint8_t address() const { return address_; }

  // The board pulls one of the lines low, or releases it.
  void edge(uint32_t pin, bool level, Ticks clock);
  // Whether it pulls the data line low.
  bool pulls() const { return pulls_; }

  // A whole transfer at once: `out` is written, then `in` is read, as many bytes as it has.
  I2cStatus exchange(const Bytes& out, Bytes& in, Ticks clock);

 private:
  enum class Mode : uint8_t { idle, addressed, takes, gives };
  I2cPins pins_;
  uint8_t address_;
  I2cChip chip_;
  Mode mode_ = Mode::idle;
  bool clock_level_ = true, data_level_ = true, pulls_ = false;
  uint8_t byte_ = 0;
  int bits_ = 0;  // of the byte; the ninth is the acknowledgement

  void rise();
  void fall(Ticks clock);
  bool acknowledges(Ticks clock);
};

}  // namespace passo::wire
