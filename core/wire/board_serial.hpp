// UARTs of motor drivers and SPI devices of the virtual board, datagram by datagram.
#pragma once
#include <cstdint>
#include <tuple>
#include <utility>

#include "bench.hpp"
#include "board_protocol.hpp"

namespace passo::wire {

inline constexpr size_t kUartBytes = 10;  // of bits, either way

// A UART whose answers come when the firmware's would.
class BoardUart {
 public:
  BoardUart(uint32_t rx_pin, Ticks bit) : rx_pin_(rx_pin), bit_(bit) {}

  Ticks next() const { return due_; }
  // False while it is busy.
  bool send(Ticks now, Ticks rest, const Bytes& bits, size_t read, Plant& plant) {
    if (due_ != kNever) return false;
    if (bits.size() > kUartBytes || read > kUartBytes) throw Shutdown{Fault::uart_too_long};
    int delay = 0;
    answer_.clear();
    if (UartLine* line = plant.uart(rx_pin_)) std::tie(answer_, delay) = line->exchange(bits);
    due_ = now + rest + Ticks(8 * bits.size()) * bit_;
    if (read == 0) {
      answer_.clear();
      return true;
    }
    Ticks look = bit_ / 4;  // four a bit, from the fourth bit on
    Ticks looks = answer_.empty() ? 257 : ((delay - 4) * bit_ + look - 1) / look + 1;
    due_ += 4 * bit_ + (looks - 1) * look;
    // Where nobody answers the last look ends it; else the bits are read from the next look on.
    if (!answer_.empty()) due_ += look + Ticks(8 * read - 1) * bit_;
    return true;
  }
  Bytes take() {
    due_ = kNever;
    return std::exchange(answer_, {});
  }

 private:
  uint32_t rx_pin_;
  Ticks bit_, due_ = kNever;
  Bytes answer_;
};

// What is selected by a pin.
struct BoardSpi {
  uint32_t select_pin;
  bool has_bus = false;

  explicit BoardSpi(uint32_t pin) : select_pin(pin) {}
  static Ticks next() { return kNever; }
  Bytes transfer(Ticks now, const Bytes& data, Plant& plant) const {
    if (!has_bus) throw Shutdown{Fault::spi_without_bus};
    SpiDevice* device = plant.spi_device(select_pin);
    return device ? device->exchange(data, now) : Bytes(data.size(), 0xff);
  }
};

}  // namespace passo::wire
