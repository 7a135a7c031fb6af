// A simulated device on an SPI bus, at the level of its pins.
#pragma once
#include <cstdint>
#include <functional>
#include <utility>

#include "link/device.hpp"

namespace passo::wire {

struct SpiPins {
  uint32_t select, clock, to_device, from_device;
};

// The device is selected while its pin is low. When a transfer starts, `answer` returns the bytes
// to send; when it ends, `take` receives the bytes from the board. If the device has registers, the
// first byte from the board is an address, and `read` returns the bytes to send after it. If
// the device has a shift register of `echo_bits`, it returns each received bit after that many
// bits.
class SpiDevice {
 public:
  SpiDevice(SpiPins pins, int mode, std::function<Bytes(Ticks)> answer,
            std::function<void(const Bytes&)> take,
            std::function<Bytes(uint8_t, Ticks)> read = nullptr, int echo_bits = 0)
      : pins_(pins), rest_(mode >> 1), second_phase_(mode & 1), answer_(std::move(answer)),
        take_(std::move(take)), read_(std::move(read)), echo_bits_(echo_bits) {}

  const SpiPins& pins() const { return pins_; }

  // The board changes the level of a pin.
  void edge(uint32_t pin, bool level, Ticks clock);
  // Whether the device drives this pin. level(): to which level.
  bool drives(uint32_t pin) const { return selected_ && pin == pins_.from_device; }
  bool level() const;

  // A complete transfer.
  Bytes exchange(const Bytes& in, Ticks clock);

 private:
  SpiPins pins_;
  bool rest_, second_phase_;
  std::function<Bytes(Ticks)> answer_;
  std::function<void(const Bytes&)> take_;
  std::function<Bytes(uint8_t, Ticks)> read_;
  int echo_bits_;
  bool selected_ = false, data_ = false;
  Bytes out_, in_;
  int next_out_ = 0, bits_in_ = 0;

  static void append(Bytes& out, const Bytes& more);
  void sample(Ticks clock);
  bool received(int bit) const;
};

}  // namespace passo::wire
