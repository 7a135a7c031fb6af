// Inputs that the virtual board samples together and reports when they change.
#pragma once
#include <algorithm>
#include <cstdint>
#include <optional>
#include <vector>

#include "link/device.hpp"

namespace passo::wire {

// A level is valid if two samples in a row agree. The board keeps each new state until the host
// acknowledges it. It reports unacknowledged states again after `retransmit` samples.
struct BoardButtons {
  static constexpr size_t kMax = 8;  // maximum number of inputs, and of unacknowledged states

  std::vector<std::optional<uint32_t>> pins;
  Ticks due = kNever, rest = 0;
  uint8_t retransmit = 0, invert = 0, acknowledged = 0;
  Bytes states;

  explicit BoardButtons(size_t count) : pins(count) {}
  Ticks next() const { return due; }

  void query(Ticks begin, Ticks rest_ticks, uint8_t retransmit_count, uint8_t inverted) {
    due = begin;
    rest = rest_ticks;
    retransmit = retransmit_count;
    invert = inverted;
    seen_ = kept_ = acknowledged = 0;
    states.clear();
  }

  // Takes a sample; level(pin) reads an input. Returns whether the states must be reported now.
  template <class Level>
  bool run(const Level& level) {
    uint8_t state = 0;
    for (size_t i = 0; i < pins.size(); ++i)
      if (pins[i] && level(*pins[i])) state |= uint8_t(1u << i);
    state ^= invert;
    uint8_t settled = uint8_t(~(state ^ seen_));
    uint8_t next = uint8_t((kept_ & ~settled) | (state & settled));
    seen_ = state;
    due += rest;
    if (next != kept_ && states.size() < kMax) {
      kept_ = next;
      states.push_back(next);
    } else if (states.empty() || retransmit == 0 || --wait_ > 0) {
      return false;
    }
    wait_ = retransmit;
    return true;
  }

  void acknowledge(size_t count) {
    count = std::min(count, states.size());
    acknowledged = uint8_t(acknowledged + count);
    states.erase(states.begin(), states.begin() + long(count));
  }

 private:
  uint8_t seen_ = 0, kept_ = 0, wait_ = 0;
};

}  // namespace passo::wire
