// Fingerprint of a job: 64 bits over its messages in order, whatever frames carried them.
#pragma once
#include <cstdint>
#include <string>

#include "base/types.hpp"

namespace passo::wire {

// Made of integers alone, so it is the same on every CPU. Multiply and rotate as in MurmurHash3
// (public domain); the multipliers are odd numbers from the digits of the golden ratio and of π.
class StreamHash {
 public:
  static uint64_t of_name(const std::string& name) {
    uint64_t h = 0xcbf29ce484222325;  // FNV-1a
    for (char c : name) h = (h ^ uint8_t(c)) * 0x100000001b3;
    return h;
  }

  // `name` is of_name() of the message's stepper or pin. Clocks count from the start of the job.
  void add(const Message& m, uint64_t name) {
    uint64_t what = name + (uint64_t(m.kind) << 1 | m.dir);
    uint64_t shape = uint64_t(m.interval) << 32 | uint64_t(m.count) << 16 | uint16_t(m.add);
    uint64_t mixed = what * kA ^ rotate(shape * kB, 31) ^ rotate(uint64_t(m.clock) * kC, 17);
    state_ = rotate(state_ ^ mixed, 27) * kA + kD;
    ++count_;
  }
  uint64_t value() const {
    uint64_t h = state_ ^ count_;
    h = (h ^ (h >> 33)) * 0xff51afd7ed558ccd;
    h = (h ^ (h >> 33)) * 0xc4ceb9fe1a85ec53;
    return h ^ (h >> 33);
  }

 private:
  static constexpr uint64_t kA = 0x9e3779b97f4a7c15, kB = 0x243f6a8885a308d3,
                            kC = 0x13198a2e03707345, kD = 0xa4093822299f31d1;
  static uint64_t rotate(uint64_t x, int n) { return x << n | x >> (64 - n); }
  uint64_t state_ = kD, count_ = 0;
};

}  // namespace passo::wire
