// A simulated device on an SPI bus, as levels of pins.
#pragma once
#include <cstdint>
#include <functional>
#include <utility>

#include "link/device.hpp"

namespace passo::wire {

struct SpiPins {
  uint32_t select, clock, to_device, from_device;
};

// Selected while its pin is low. `answer` gives, when a transfer begins, what comes back during it;
// `take` gets what came in. Of a device with registers `read` gives what comes back behind the
// first byte, which is an address.
class SpiDevice {
 public:
  SpiDevice(SpiPins pins, int mode, std::function<Bytes(Ticks)> answer,
            std::function<void(const Bytes&)> take,
            std::function<Bytes(uint8_t, Ticks)> read = nullptr)
      : pins_(pins), rest_(mode >> 1), second_phase_(mode & 1), answer_(std::move(answer)),
        take_(std::move(take)), read_(std::move(read)) {}

  const SpiPins& pins() const { return pins_; }

  // The board drives one of the pins to a level.
  void edge(uint32_t pin, bool level, Ticks clock) {
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
  // Whether it drives its pin, and to which level.
  bool drives(uint32_t pin) const { return selected_ && pin == pins_.from_device; }
  bool level() const {
    auto bit = size_t(next_out_);
    return next_out_ < 0 || bit >= 8 * out_.size() || (out_[bit / 8] >> (7 - bit % 8) & 1);
  }

  // A whole transfer at once.
  Bytes exchange(const Bytes& in, Ticks clock) {
    Bytes out = answer_(clock);
    if (read_ && !in.empty()) append(out, read_(in[0], clock));
    take_(in);
    out.resize(in.size(), 0xff);
    return out;
  }

 private:
  SpiPins pins_;
  bool rest_, second_phase_;
  std::function<Bytes(Ticks)> answer_;
  std::function<void(const Bytes&)> take_;
  std::function<Bytes(uint8_t, Ticks)> read_;
  bool selected_ = false, data_ = false;
  Bytes out_, in_;
  int next_out_ = 0, bits_in_ = 0;

  static void append(Bytes& out, const Bytes& more) {
    out.insert(out.end(), more.begin(), more.end());
  }
  void sample(Ticks clock) {
    if (bits_in_++ % 8 == 0) in_.push_back(0);
    in_.back() = uint8_t((in_.back() << 1) | data_);
    if (read_ && bits_in_ == 8) append(out_, read_(in_[0], clock));
  }
};

}  // namespace passo::wire
