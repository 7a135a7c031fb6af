// A simulated accelerometer on an SPI or I2C bus, according to its data sheet.
#pragma once
#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <utility>

#include "link/device.hpp"
#include "sim/i2c_device.hpp"

namespace passo::wire {

// An ADXL345 (13 bits, ±16 g, 3200 samples per second) or a LIS2DW (14 bits, ±16 g, 1600). It
// measures the acceleration of the part that it is mounted on, and gravity along Z. A sample is the
// mean over its interval, with noise. The FIFO holds 32 samples; when it is full, the oldest is
// lost. If not `plugged`, the chip does not answer.
class AccelerometerChip {
 public:
  enum class Kind : uint8_t { adxl345, lis2dw };
  // Velocity of the part that carries the chip, mm/s, at a clock. The clock does not decrease from
  // call to call.
  using Velocity = std::function<std::array<double, 3>(Ticks)>;
  static constexpr double kNoise = 50;  // mm/s², rms

  AccelerometerChip(Kind kind, double clock_hz) : kind_(kind), hz_(clock_hz) {}

  // Mounts the chip. It calls `measures` when it starts or stops measuring.
  void place(Velocity velocity, std::function<void(bool)> measures) {
    velocity_ = std::move(velocity);
    measures_ = std::move(measures);
  }
  bool plugged = true;
  int nacks = 0;          // a fault: the next addresses on I2C that are not acknowledged
  double rate_error = 0;  // error of the chip's clock, as a fraction

  // A transfer starts.
  Bytes answer(Ticks clock);
  // The bytes that follow the address in a read transfer.
  Bytes read(uint8_t address, Ticks clock);
  // The bytes of a complete transfer.
  void take(const Bytes& in);

  // The chip on I2C, byte by byte.
  static I2cChip on_i2c(std::shared_ptr<AccelerometerChip> chip);

 private:
  static constexpr size_t kFifo = 32;
  static constexpr double kGravity = 9806.65;  // mm/s²
  struct Sample {
    std::array<int16_t, 3> raw;
  };
  const Kind kind_;
  const double hz_;
  Velocity velocity_ = [](Ticks) { return std::array<double, 3>{}; };
  std::function<void(bool)> measures_ = [](bool) {};
  std::array<uint8_t, 64> registers_{};
  bool measuring_ = false, overflow_ = false;
  Ticks now_ = 0;
  double next_ = 0;  // clock of the next sample
  std::array<double, 3> last_{};
  std::deque<Sample> fifo_;
  Sample shown_{};
  uint8_t pointer_ = 0;  // next register on I2C
  bool pointed_ = false;
  uint64_t random_ = 0x9e3779b97f4a7c15u;

  double interval() const;
  void fill(Ticks clock);
  void show(uint8_t address);
  bool begin(bool reads);
  bool take(uint8_t byte, Ticks clock);
  uint8_t give(Ticks clock);
  int16_t quantized(double mm_s2, int axis);
  void write(uint8_t address, uint8_t value);
  uint8_t at(uint8_t address) const;
  double normal();
};

}  // namespace passo::wire
