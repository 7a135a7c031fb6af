// The far end of a link, in the same process: it takes bytes and gives bytes, in virtual time.
#pragma once
#include <cstdint>
#include <limits>

#include "link/frame.hpp"

namespace passo::wire {

using Ticks = int64_t;
inline constexpr Ticks kNever = std::numeric_limits<Ticks>::max();

class Device {
 public:
  virtual ~Device() = default;
  // Takes bytes from the host. `now` is the device's own clock and never runs backwards.
  virtual void feed(const uint8_t* data, size_t n, Ticks now) = 0;
  // Does all that is due until `now` and appends its messages to the host.
  virtual void poll(Ticks now, Bytes& out) = 0;
  // When it next has something to do by itself; kNever if only bytes can wake it.
  virtual Ticks next_deadline() const = 0;
  // True while it refuses to work; the host learns of it by messages alone.
  virtual bool stopped() const = 0;
};

}  // namespace passo::wire
