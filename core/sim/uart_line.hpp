// The UART of simulated motor drivers, at the level of pins. Like real drivers, they measure the
// length of a bit in the first byte of each datagram.
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

  // The board changes the level of its pin.
  void edge(bool level, Ticks clock);
  // The level that the board reads.
  bool level(Ticks clock);
  // Receives all bytes up to `clock`.
  void run(Ticks clock);

  // Receives these bits, which include start and stop bits, lowest bit of each byte first. Returns
  // the bits of the answer, and the number of bits before it.
  std::pair<Bytes, int> exchange(const Bytes& bits);

 private:
  static constexpr double kPause = 63;  // bits
  uint32_t rx_pin_, tx_pin_;
  bool level_ = true;
  Ticks start_ = kNever;  // start of the current byte
  Ticks last_ = 0;
  double bit_ = 0;  // ticks; 0 until the sync nibble is received
  int bit_number_ = 0, falls_ = 0;
  uint8_t byte_ = 0;
  Bytes bytes_;
  std::vector<bool> answer_;
  Ticks answer_start_ = 0;
  double answer_bit_ = 1;
  int delay_ = 0;  // bits before the last answer

  void restart();
  void received(Ticks end);
  Bytes ask(const Bytes& bytes);
  static std::vector<bool> serial(const Bytes& bytes);
};

}  // namespace passo::wire
