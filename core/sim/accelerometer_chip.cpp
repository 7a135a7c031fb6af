#include "sim/accelerometer_chip.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace passo::wire {

namespace {

constexpr uint8_t kRead = 0x80, kAddress = 0x3f;

// Registers of the ADXL345 (Analog Devices, rev. G) and of the LIS2DW12 (ST, DocID030836).
constexpr uint8_t kAdxlRate = 0x2c, kAdxlPower = 0x2d, kAdxlData = 0x32, kAdxlFifo = 0x39;
constexpr uint8_t kLisOdr = 0x20, kLisData = 0x28, kLisFifo = 0x2f;
constexpr uint8_t kAdxlId = 0xe5, kLisId = 0x44;

}  // namespace

double AccelerometerChip::interval() const {
  // Each step of the register doubles the rate.
  const int adxl = (registers_[kAdxlRate] & 0x0f) - 15, lis = (registers_[kLisOdr] >> 4) - 9;
  const double rate = kind_ == Kind::adxl345 ? std::ldexp(3200, adxl) : std::ldexp(1600, lis);
  return hz_ / (rate * (1 + rate_error));
}

Bytes AccelerometerChip::answer(Ticks clock) {
  now_ = clock;
  return {0xff};
}

Bytes AccelerometerChip::read(uint8_t address, Ticks clock) {
  if (!plugged || !(address & kRead)) return {};
  fill(clock);
  const uint8_t first = address & kAddress;
  show(first);
  Bytes out;
  for (uint8_t i = 0; i < 8; ++i) out.push_back(at(uint8_t((first + i) & kAddress)));
  if (first == kLisFifo && kind_ == Kind::lis2dw) overflow_ = false;
  return out;
}

// Before a read of the first data register, the next sample leaves the FIFO.
void AccelerometerChip::show(uint8_t address) {
  if (address != (kind_ == Kind::adxl345 ? kAdxlData : kLisData) || fifo_.empty()) return;
  shown_ = fifo_.front();
  fifo_.pop_front();
}

I2cChip AccelerometerChip::on_i2c(std::shared_ptr<AccelerometerChip> chip) {
  return {[chip](bool reads, Ticks) { return chip->begin(reads); },
          [chip](uint8_t byte, Ticks clock) { return chip->take(byte, clock); },
          [chip](Ticks clock) { return chip->give(clock); }};
}

bool AccelerometerChip::begin(bool reads) {
  if (!reads) pointed_ = false;
  if (nacks == 0) return plugged;
  --nacks;
  return false;
}

// The first byte of a write is the address of a register.
bool AccelerometerChip::take(uint8_t byte, Ticks clock) {
  now_ = clock;
  if (std::exchange(pointed_, true))
    write(pointer_++ & kAddress, byte);
  else
    pointer_ = byte;
  return true;
}

// The register after the last byte of a sample is the first byte of the next sample.
uint8_t AccelerometerChip::give(Ticks clock) {
  fill(clock);
  const uint8_t address = pointer_ & kAddress;
  show(address);
  const uint8_t value = at(address);
  const bool lis = kind_ == Kind::lis2dw;
  if (lis && address == kLisFifo) overflow_ = false;
  pointer_ = uint8_t(lis && address == kLisData + 5 ? kLisData : address + 1);
  return value;
}

void AccelerometerChip::take(const Bytes& in) {
  if (!plugged || in.size() < 2 || (in[0] & kRead)) return;
  for (size_t i = 1; i < in.size(); ++i) write(uint8_t((in[0] + i - 1) & kAddress), in[i]);
}

void AccelerometerChip::write(uint8_t address, uint8_t value) {
  registers_[address] = value;
  const uint8_t power = kind_ == Kind::adxl345 ? kAdxlPower : kLisOdr;
  if (address != power) return;
  const bool on = kind_ == Kind::adxl345 ? value & 0x08 : value & 0xf0;
  if (on == measuring_) return;
  measuring_ = on;
  measures_(on);
  fifo_.clear();
  overflow_ = false;
  if (!on) return;
  last_ = velocity_(now_);
  next_ = double(now_) + interval();
}

uint8_t AccelerometerChip::at(uint8_t address) const {
  const bool adxl = kind_ == Kind::adxl345;
  if (address == (adxl ? 0x00 : 0x0f)) return adxl ? kAdxlId : kLisId;
  if (address == (adxl ? kAdxlFifo : kLisFifo))
    return uint8_t(fifo_.size() | (!adxl && overflow_ ? 0x40 : 0));
  const uint8_t data = adxl ? kAdxlData : kLisData;
  if (address >= data && address < data + 6) {
    const auto raw = uint16_t(shown_.raw[size_t(address - data) / 2]);
    return uint8_t((address - data) % 2 ? raw >> 8 : raw);
  }
  return registers_[address];
}

void AccelerometerChip::fill(Ticks clock) {
  if (!measuring_) return;
  const double step = interval(), seconds = step / hz_;
  for (; next_ <= double(clock); next_ += step) {
    const std::array<double, 3> now = velocity_(Ticks(next_));
    Sample sample;
    for (size_t axis = 0; axis < 3; ++axis) {
      double felt = (now[axis] - last_[axis]) / seconds + (axis == 2 ? kGravity : 0);
      sample.raw[axis] = quantized(felt + kNoise * normal(), int(axis));
    }
    last_ = now;
    fifo_.push_back(sample);
    if (fifo_.size() <= kFifo) continue;
    fifo_.pop_front();
    overflow_ = true;
  }
}

int16_t AccelerometerChip::quantized(double mm_s2, int axis) {
  if (kind_ == Kind::adxl345) {
    const double unit = (axis == 2 ? 0.003906 : 0.003774) * kGravity;
    return int16_t(std::clamp(std::floor(mm_s2 / unit + 0.5), -4096.0, 4095.0));
  }
  const double unit = 0.001952 * kGravity;
  return int16_t(std::clamp(std::floor(mm_s2 / unit + 0.5), -8192.0, 8191.0) * 4);
}

// The sum of twelve numbers from 0 to 1, minus 6, has nearly a normal distribution. The numbers are
// from xorshift64 (Marsaglia 2003).
double AccelerometerChip::normal() {
  double sum = -6;
  for (int i = 0; i < 12; ++i) {
    random_ ^= random_ << 13;
    random_ ^= random_ >> 7;
    random_ ^= random_ << 17;
    sum += double(random_ >> 11) / 9007199254740992.0;
  }
  return sum;
}

}  // namespace passo::wire
