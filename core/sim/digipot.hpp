// A simulated digital potentiometer that sets the currents of motor drivers.
#pragma once
#include <array>
#include <cstdint>

#include "link/device.hpp"

namespace passo::wire {

// An AD5206 (Analog Devices, data sheet Rev. E). The last eleven bits of a transfer count: three
// for the address, eight for the position of the wiper. The wipers start in the middle. The chip
// does not answer.
class Digipot {
 public:
  void take(const Bytes& in) {
    uint32_t word = 0;
    for (uint8_t byte : in) word = word << 8 | byte;
    if (size_t channel = word >> 8 & 7; channel < wipers_.size()) wipers_[channel] = uint8_t(word);
  }
  uint8_t wiper(size_t channel) const { return wipers_.at(channel); }

 private:
  std::array<uint8_t, 6> wipers_{128, 128, 128, 128, 128, 128};
};

}  // namespace passo::wire
