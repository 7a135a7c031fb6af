#include "sim/spi_device.hpp"

#include <algorithm>

namespace passo::wire {

void SpiDevice::edge(uint32_t pin, bool level, Ticks clock) {
  if (pin == pins_.to_device) data_ = level;
  if (pin == pins_.select) {
    if (selected_ && level) take_(in_);
    selected_ = !level;
    if (!selected_) return;
    out_ = answer_(clock);
    in_.clear();
    next_out_ = second_phase_ ? -1 : 0;
    bits_in_ = 0;
  } else if (pin == pins_.clock && selected_) {
    if ((level != rest_) == second_phase_)
      ++next_out_;
    else
      sample(clock);
  }
}

bool SpiDevice::level() const {
  if (echo_bits_ > 0 && next_out_ >= echo_bits_) return received(next_out_ - echo_bits_);
  auto bit = size_t(next_out_);
  return next_out_ < 0 || bit >= 8 * out_.size() || (out_[bit / 8] >> (7 - bit % 8) & 1);
}

Bytes SpiDevice::exchange(const Bytes& in, Ticks clock) {
  Bytes out = answer_(clock);
  if (read_ && !in.empty()) append(out, read_(in[0], clock));
  take_(in);
  out.resize(in.size(), 0xff);
  for (int bit = echo_bits_; echo_bits_ > 0 && bit < int(8 * out.size()); ++bit) {
    int from = bit - echo_bits_;
    bool one = in[size_t(from / 8)] >> (7 - from % 8) & 1;
    auto mask = uint8_t(0x80 >> bit % 8);
    out[size_t(bit / 8)] = uint8_t((out[size_t(bit / 8)] & ~mask) | (one ? mask : 0));
  }
  return out;
}

bool SpiDevice::received(int bit) const {
  if (bit >= bits_in_) return true;
  int in_byte = std::min(8, bits_in_ - bit / 8 * 8);  // bits of its byte that have arrived
  return in_[size_t(bit / 8)] >> (in_byte - 1 - bit % 8) & 1;
}

void SpiDevice::append(Bytes& out, const Bytes& more) {
  out.insert(out.end(), more.begin(), more.end());
}

void SpiDevice::sample(Ticks clock) {
  if (bits_in_++ % 8 == 0) in_.push_back(0);
  in_.back() = uint8_t((in_.back() << 1) | data_);
  if (read_ && bits_in_ == 8) append(out_, read_(in_[0], clock));
}

}  // namespace passo::wire
