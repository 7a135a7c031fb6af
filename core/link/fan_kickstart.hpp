// Starts a fan: full power for a time, because its set power may not be enough to start it.
#pragma once
#include <cstdint>

#include "link/device.hpp"

namespace passo::wire {

class Kick {
 public:
  Kick() = default;  // no kickstart
  // If the fan's value rises from 0, or by more than `rise`, it is `full` for this many ticks.
  Kick(Ticks ticks, uint32_t full, uint32_t rise) : ticks_(ticks), full_(full), rise_(rise) {}

  explicit operator bool() const { return ticks_ > 0; }
  // The clock at which the kickstart ends; kNever without a kickstart.
  Ticks end() const { return end_; }
  uint32_t asked() const { return asked_; }
  // The value of the fan at `clock`, before end(), if `asked` is requested and the fan has `value`.
  // Only 0 and values above `full` end a kickstart.
  uint32_t value_at(uint32_t asked, uint32_t value, Ticks clock) {
    bool goes_on = end_ != kNever, starts = value == 0 || asked > uint64_t(value) + rise_;
    asked_ = asked;
    recent_ = asked > 0 && asked < full_ && (goes_on || starts);
    if (!recent_) end_ = kNever;
    if (recent_ && !goes_on) end_ = clock + ticks_;
    return recent_ ? full_ : asked;
  }
  void over() { end_ = kNever; }
  // The board may not have received the last messages. Returns true if they concerned a kickstart:
  // then the fan must get its set value at once, because its present value is unknown.
  bool interrupt() {
    if (recent_) end_ = 0;
    return recent_;
  }
  void forget() { recent_ = false, end_ = kNever; }

 private:
  Ticks ticks_ = 0, end_ = kNever;
  uint32_t full_ = 0, rise_ = 0, asked_ = 0;
  bool recent_ = false;  // the last messages concerned a kickstart
};

}  // namespace passo::wire
