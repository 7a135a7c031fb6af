#include "sim/uart_line.hpp"

namespace passo::wire {

void UartLine::edge(bool level, Ticks clock) {
  run(clock);
  level_ = level;
  if (start_ == kNever) {
    if (level) return;
    // After a long pause within a datagram, the next byte starts a new datagram.
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

bool UartLine::level(Ticks clock) {
  run(clock);
  if (answer_.empty() || clock < answer_start_) return true;
  auto bit = uint64_t(double(clock - answer_start_) / answer_bit_);
  return bit >= answer_.size() || answer_[bit];
}

void UartLine::run(Ticks clock) {
  while (start_ != kNever && bit_ > 0) {
    // Bit 0 is the start bit, bit 9 the stop bit. The sync nibble gives the length of four bits of
    // the first byte.
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
      received(end);
  }
}

std::pair<Bytes, int> UartLine::exchange(const Bytes& bits) {
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

void UartLine::restart() {
  bytes_.clear();
  bit_ = 0;
}

void UartLine::received(Ticks end) {
  answer_ = serial(ask(bytes_));
  answer_bit_ = bit_;
  answer_start_ = end + Ticks(delay_ * bit_);
  restart();
}

Bytes UartLine::ask(const Bytes& bytes) {
  Bytes answer;
  for (auto& chip : chips) {
    Bytes own = chip->datagram(bytes);
    if (own.empty()) continue;
    answer = own;
    delay_ = chip->answer_delay();
  }
  return answer;
}

std::vector<bool> UartLine::serial(const Bytes& bytes) {
  std::vector<bool> bits;
  for (uint8_t byte : bytes) {
    bits.push_back(false);
    for (int bit = 0; bit < 8; ++bit) bits.push_back(byte >> bit & 1);
    bits.push_back(true);
  }
  return bits;
}

}  // namespace passo::wire
