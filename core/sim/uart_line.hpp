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
  void edge(bool level, Ticks clock) {
    run(clock);
    level_ = level;
    if (start_ == kNever) {
      if (level) return;
      // A pause in the midst of a datagram: what comes is another one.
      if (!bytes_.empty() && clock - last_ > kPause * bit_) restart();
      start_ = last_ = clock;
      bit_number_ = 0;
      byte_ = 0;
      falls_ = 1;
    } else if (bytes_.empty() && !level && ++falls_ == 3) {
      bit_ = double(clock - start_) / 4;
      bit_number_ = 4;
      byte_ = 0x05;
    }
  }
  // The level that the board reads.
  bool level(Ticks clock) {
    run(clock);
    if (answer_.empty() || clock < answer_start_) return true;
    auto bit = uint64_t(double(clock - answer_start_) / answer_bit_);
    return bit >= answer_.size() || answer_[bit];
  }
  // All that has come until `clock` is heard.
  void run(Ticks clock) {
    while (start_ != kNever && bit_ > 0) {
      // Bit 9 is the stop bit; the start bit is bit 0. Four of the first byte make the sync.
      Ticks at = start_ + Ticks((bit_number_ + 0.5) * bit_);
      if (at >= clock) return;
      if (bit_number_ >= 1 && bit_number_ <= 8)
        byte_ = uint8_t((byte_ & ~(1 << (bit_number_ - 1))) | (level_ << (bit_number_ - 1)));
      if (bit_number_++ < 9) continue;
      bytes_.push_back(byte_);
      Ticks end = start_ + Ticks(10 * bit_);
      start_ = kNever;
      bool write = bytes_.size() > 2 && (bytes_[2] & 0x80);
      if (!level_)
        restart();
      else if (bytes_.size() == (write ? 8u : 4u))
        heard(end);
    }
  }

  // As if these bits (start and stop bits included, each byte's lowest bit first) had come: the
  // answer's, and after how many bits it begins.
  std::pair<Bytes, int> exchange(const Bytes& bits) {
    Bytes bytes;
    for (size_t i = 0; i + 10 <= bits.size() * 8; i += 10) {
      uint8_t byte = 0;
      for (size_t bit = 0; bit < 8; ++bit)
        byte |= uint8_t((bits[(i + 1 + bit) >> 3] >> ((i + 1 + bit) & 7) & 1) << bit);
      bytes.push_back(byte);
    }
    std::vector<bool> answer = serial(ask(bytes));
    Bytes packed((answer.size() + 7) / 8);
    for (size_t i = 0; i < answer.size(); ++i) packed[i / 8] |= uint8_t(answer[i] << (i % 8));
    return {packed, delay_};
  }

 private:
  static constexpr double kPause = 63;  // bits
  uint32_t rx_pin_, tx_pin_;
  bool level_ = true;
  Ticks start_ = kNever;  // of the byte that comes, and of the last one
  Ticks last_ = 0;
  double bit_ = 0;  // ticks; 0 until the sync nibble has come
  int bit_number_ = 0, falls_ = 0;
  uint8_t byte_ = 0;
  Bytes bytes_;
  std::vector<bool> answer_;
  Ticks answer_start_ = 0;
  double answer_bit_ = 1;
  int delay_ = 0;  // of the last answer, bits

  void restart() {
    bytes_.clear();
    bit_ = 0;
  }
  void heard(Ticks end) {
    answer_ = serial(ask(bytes_));
    answer_bit_ = bit_;
    answer_start_ = end + Ticks(delay_ * bit_);
    restart();
  }
  Bytes ask(const Bytes& bytes) {
    Bytes answer;
    for (auto& chip : chips) {
      Bytes own = chip->datagram(bytes);
      if (own.empty()) continue;
      answer = own;
      delay_ = chip->answer_delay();
    }
    return answer;
  }
  static std::vector<bool> serial(const Bytes& bytes) {
    std::vector<bool> bits;
    for (uint8_t byte : bytes) {
      bits.push_back(false);
      for (int bit = 0; bit < 8; ++bit) bits.push_back(byte >> bit & 1);
      bits.push_back(true);
    }
    return bits;
  }
};

}  // namespace passo::wire
