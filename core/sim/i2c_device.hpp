// A simulated device on an I2C bus, at the level of its two lines.
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

// How a transfer ended. The numbers are those of the enumeration `i2c_bus_status`.
enum class I2cStatus : uint8_t { success, nack, bus_timeout, start_nack, start_read_nack };

// A chip on the bus. begin(): it is addressed for a write or a read. take(): it receives a byte.
// Both return whether it acknowledges. give(): it sends a byte.
struct I2cChip {
  std::function<bool(bool reads, Ticks)> begin;
  std::function<bool(uint8_t byte, Ticks)> take;
  std::function<uint8_t(Ticks)> give;
};

class I2cDevice {
 public:
  I2cDevice(I2cPins pins, uint8_t address, I2cChip chip)
      : pins_(pins), address_(address), chip_(std::move(chip)) {}

  const I2cPins& pins() const { return pins_; }
  uint8_t address() const { return address_; }

  // The board pulls a line low, or releases it.
  void edge(uint32_t pin, bool level, Ticks clock);
  // Whether the device pulls the data line low.
  bool pulls() const { return pulls_; }

  // A complete transfer: `out` is written, then `in` is filled.
  I2cStatus exchange(const Bytes& out, Bytes& in, Ticks clock);

 private:
  enum class Mode : uint8_t { idle, addressed, takes, gives };
  I2cPins pins_;
  uint8_t address_;
  I2cChip chip_;
  Mode mode_ = Mode::idle;
  bool clock_level_ = true, data_level_ = true, pulls_ = false;
  uint8_t byte_ = 0;
  int bits_ = 0;  // of the byte; bit 9 is the acknowledgement

  void rise();
  void fall(Ticks clock);
  bool acknowledges(Ticks clock);
};

}  // namespace passo::wire
