#include "sim/i2c_device.hpp"

namespace passo::wire {

void I2cDevice::edge(uint32_t pin, bool level, Ticks clock) {
  if (pin == pins_.clock) {
    clock_level_ = level;
    if (level)
      rise();
    else
      fall(clock);
  } else if (pin == pins_.data) {
    data_level_ = level;
    if (!clock_level_) return;
    // The data line changes while the clock is high: a transfer starts or ends.
    mode_ = level ? Mode::idle : Mode::addressed;
    bits_ = 0;
    pulls_ = false;
  }
}

void I2cDevice::rise() {
  if (mode_ == Mode::idle) return;
  if (bits_ < 8 && mode_ != Mode::gives) byte_ = uint8_t(byte_ << 1 | data_level_);
  if (bits_ == 8 && mode_ == Mode::gives && data_level_)
    mode_ = Mode::idle;  // not acknowledged: the host has read enough
  ++bits_;
}

void I2cDevice::fall(Ticks clock) {
  pulls_ = false;
  if (mode_ == Mode::idle) return;
  if (bits_ == 8 && mode_ != Mode::gives) {
    pulls_ = acknowledges(clock);
    if (!pulls_) mode_ = Mode::idle;
  } else if (bits_ > 8) {
    bits_ = 0;
    if (mode_ == Mode::addressed) mode_ = byte_ & 1 ? Mode::gives : Mode::takes;
    if (mode_ == Mode::gives) byte_ = chip_.give(clock);
  }
  if (mode_ == Mode::gives && bits_ < 8) pulls_ = !(byte_ >> (7 - bits_) & 1);
}

bool I2cDevice::acknowledges(Ticks clock) {
  if (mode_ == Mode::takes) return chip_.take(byte_, clock);
  return byte_ >> 1 == address_ && chip_.begin(byte_ & 1, clock);
}

I2cStatus I2cDevice::exchange(const Bytes& out, Bytes& in, Ticks clock) {
  if (!out.empty() || in.empty()) {
    if (!chip_.begin(false, clock)) return I2cStatus::start_nack;
    for (uint8_t byte : out)
      if (!chip_.take(byte, clock)) return I2cStatus::nack;
  }
  if (in.empty()) return I2cStatus::success;
  if (!chip_.begin(true, clock)) return I2cStatus::start_read_nack;
  for (uint8_t& byte : in) byte = chip_.give(clock);
  return I2cStatus::success;
}

}  // namespace passo::wire
