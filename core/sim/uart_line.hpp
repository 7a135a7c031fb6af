// The UART of simulated motor drivers, as levels of pins: the drivers take the length of a bit from
// each datagram's first byte, as real ones do.
#pragma once
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "link/device.hpp"
#include "sim/trinamic.hpp"

namespace passo::wire {

class UartLine {
 public:
  std::vector<std::shared_ptr<TrinamicChip>> chips;

  UartLine(uint32_t rx_pin, uint32_t tx_pin) : rx_pin_(rx_pin), tx_pin_(tx_pin) {}
  uint32_t rx_pin() const { return rx_pin_; }
  uint32_t tx_pin() const { return tx_pin_; }

  // The board drives its pin to a level.
  void edge(bool level, Ticks clock);
  // The level that the board reads.
  bool level(Ticks clock);
  // All bytes until `clock` are received.
  void run(Ticks clock);

  // Simulates the reception of these bits (with start and stop bits, each byte's lowest bit first).
  // Returns the bits of the answer and the delay before it in bits.
  std::pair<Bytes, int> exchange(const Bytes& bits);

 private:
  static constexpr double kPause = 63;  // bits
  uint32_t rx_pin_, tx_pin_;
  bool level_ = true;
  Ticks start_ = kNever;  // of the current byte, and of the last one
  Ticks last_ = 0;
  double bit_ = 0;  // ticks; 0 until the sync nibble has come
  int bit_number_ = 0, falls_ = 0;
  uint8_t byte_ = 0;
  Bytes bytes_;
  std::vector<bool> answer_;
  Ticks answer_start_ = 0;
  double answer_bit_ = 1;
  int delay_ = 0;  // of the last answer, bits

  void restart();
  void received(Ticks end);
  Bytes ask(const Bytes& bytes);
  static std::vector<bool> serial(const Bytes& bytes);
};

}  // namespace passo::wire
