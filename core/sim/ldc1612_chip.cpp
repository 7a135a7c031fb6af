#include "sim/ldc1612_chip.hpp"

#include <algorithm>
#include <cmath>

namespace passo::wire {

namespace {

// Registers of the LDC1612 (Texas Instruments, SNOSCY9).
constexpr uint8_t kHigh = 0x00, kLow = 0x01, kCount = 0x08, kDividers = 0x14, kStatus = 0x18,
                  kConfig = 0x1a, kCurrent = 0x1e, kManufacturer = 0x7e, kDevice = 0x7f;
constexpr uint16_t kSleep = 1 << 13, kAutomatic = 1 << 12, kUnread = 1 << 3;
constexpr uint32_t kWatchdog = 0x20000000, kAmplitude = 0x10000000, kFull = 0x0fffffff;
constexpr uint16_t kBestCurrent = 15, kCurrentShift = 6;

}  // namespace

double Ldc1612Chip::frequency(double mm) const {
  return cold(std::max(mm, 0.0)) * (1 - kPerC * (celsius - 25));
}

// Above the curve, its last slope decays.
double Ldc1612Chip::cold(double mm) const {
  if (curve.size() < 2) return kFarHz + kRiseHz * std::exp(-mm / kDecayMm);
  const auto at = std::upper_bound(curve.begin() + 1, curve.end() - 1, std::pair(mm, 0.0));
  const auto [low, low_hz] = *(at - 1);
  const auto [high, high_hz] = *at;
  const double slope = (high_hz - low_hz) / (high - low);
  const double beyond = std::max(mm - high, 0.0);
  return low_hz + slope * (mm - beyond - low) +
         slope * kDecayMm * (1 - std::exp(-beyond / kDecayMm));
}

I2cChip Ldc1612Chip::on_i2c(std::shared_ptr<Ldc1612Chip> chip) {
  return {[chip](bool reads, Ticks) { return chip->begin(reads); },
          [chip](uint8_t byte, Ticks clock) { return chip->take(byte, clock); },
          [chip](Ticks clock) { return chip->give(clock); }};
}

bool Ldc1612Chip::begin(bool reads) {
  if (!reads) taken_ = 0;
  low_ = false;
  return plugged;
}

// A write is the address of a register, and its two bytes.
bool Ldc1612Chip::take(uint8_t byte, Ticks clock) {
  const int at = taken_++;
  if (at == 0)
    pointer_ = byte;
  else if (at == 1)
    high_ = byte;
  else
    write(pointer_, uint16_t(high_ << 8 | byte), clock);
  return true;
}

uint8_t Ldc1612Chip::give(Ticks clock) {
  if (std::exchange(low_, !low_)) return uint8_t(registers_[pointer_]);
  registers_[pointer_] = read(pointer_, clock);
  return uint8_t(registers_[pointer_] >> 8);
}

double Ldc1612Chip::interval() const {
  return 16.0 * std::max<double>(registers_[kCount], 1) / kClockHz * hz_;
}

void Ldc1612Chip::write(uint8_t address, uint16_t value, Ticks clock) {
  registers_[address] = value;
  if (address != kConfig) return;
  running_ = !(value & kSleep);
  unread_ = false;
  next_ = double(clock) + interval();
  // While the chip sets the current of its coil itself, it writes it into the lower half.
  if (running_ && !(value & kAutomatic))
    registers_[kCurrent] = uint16_t(kBestCurrent << kCurrentShift);
}

uint16_t Ldc1612Chip::read(uint8_t address, Ticks clock) {
  if (address == kManufacturer) return 0x5449;
  if (address == kDevice) return 0x3055;
  convert(clock);
  if (address == kStatus) return unread_ ? kUnread : 0;
  if (address == kHigh) unread_ = false;
  return registers_[address];
}

// Measures at the clock of the call, at most once in an interval.
void Ldc1612Chip::convert(Ticks clock) {
  if (!running_ || double(clock) < next_) return;
  next_ += interval() * (1 + std::floor((double(clock) - next_) / interval()));
  const double divider = std::max(registers_[kDividers] >> 12, 1);
  double hz = frequency(gap_()) + (noise_hz > 0 ? noise_.next(noise_hz) : 0);
  auto value =
      uint32_t(std::clamp(hz / divider / kClockHz * double(1 << 28) + 0.5, 0.0, double(kFull)));
  if (open) value = kWatchdog | kAmplitude;
  registers_[kHigh] = uint16_t(value >> 16);
  registers_[kLow] = uint16_t(value);
  unread_ = true;
}

}  // namespace passo::wire
