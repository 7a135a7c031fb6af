// A simulated LDC1612, which measures the frequency of a coil above the bed.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "link/device.hpp"
#include "sim/bed.hpp"
#include "sim/i2c_device.hpp"

namespace passo::wire {

// The frequency of the coil falls with its distance from the bed, from kNear mm to infinity, as
// kFarHz + kRiseHz · exp(-distance / kDecayMm). It also falls by kPerC of itself for each °C above
// 25 °C. With a `curve`, the frequencies between its heights are those of the curve. Each value has
// noise. If not `plugged`, the chip does not acknowledge; with an `open`
// coil it measures nothing.
class Ldc1612Chip {
 public:
  static constexpr double kFarHz = 3218000, kRiseHz = 68000, kDecayMm = 2.2, kPerC = 2e-6;
  static constexpr double kClockHz = 12e6;  // the oscillator of the chip

  // `gap` gives the distance from the bed now, mm.
  Ldc1612Chip(double clock_hz, std::function<double()> gap) : hz_(clock_hz), gap_(std::move(gap)) {}

  bool plugged = true, open = false;
  double celsius = 25, noise_hz = 10;
  std::vector<std::pair<double, double>> curve;  // mm, rising, and Hz

  double frequency(double mm) const;
  uint32_t register_at(uint8_t address) const { return registers_[address]; }
  static I2cChip on_i2c(std::shared_ptr<Ldc1612Chip> chip);

 private:
  const double hz_;
  std::function<double()> gap_;
  std::array<uint16_t, 256> registers_{};
  Noise noise_{1};
  uint8_t pointer_ = 0, high_ = 0;
  int taken_ = 0;     // bytes of the write so far
  bool low_ = false;  // the low byte of the register is next
  bool running_ = false, unread_ = false;
  double next_ = 0;  // clock of the next value

  bool begin(bool reads);
  bool take(uint8_t byte, Ticks clock);
  uint8_t give(Ticks clock);
  void write(uint8_t address, uint16_t value, Ticks clock);
  uint16_t read(uint8_t address, Ticks clock);
  void convert(Ticks clock);
  double interval() const;
  double cold(double mm) const;
};

}  // namespace passo::wire
