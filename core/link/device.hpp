// The far end of a link in the same process: it takes and returns bytes, in virtual time.
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
  // Executes everything that is due until `now`, and appends the device's messages to the host.
  virtual void poll(Ticks now, Bytes& out) = 0;
  // The clock of its next timer; kNever if only received bytes can wake it.
  virtual Ticks next_deadline() const = 0;
  // True while the device is shut down. The host learns this only from its messages.
  virtual bool stopped() const = 0;
};

}  // namespace passo::wire
