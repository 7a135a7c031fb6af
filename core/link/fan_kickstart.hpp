// How a fan is started: fully on for a while, for what it is asked for may not get it to turn.
#pragma once
#include <cstdint>

#include "link/device.hpp"

namespace passo::wire {

class Kick {
 public:
  Kick() = default;  // none
  // Where the fan's value comes from 0, or rises by more than `rise`, it is `full` for so many
  // ticks first.
  Kick(Ticks ticks, uint32_t full, uint32_t rise) : ticks_(ticks), full_(full), rise_(rise) {}

  explicit operator bool() const { return ticks_ > 0; }
  // The clock at which the fan gets what it was asked for; kNever while it has that.
  Ticks end() const { return end_; }
  uint32_t asked() const { return asked_; }
  // The value that the fan gets at `clock`, before end(), where `asked` is asked for and it has
  // `value`. Only 0 and all above `full` end a kick that goes on.
  uint32_t told(uint32_t asked, uint32_t value, Ticks clock) {
    bool goes_on = end_ != kNever, starts = value == 0 || asked > uint64_t(value) + rise_;
    asked_ = asked;
    recent_ = asked > 0 && asked < full_ && (goes_on || starts);
    if (!recent_) end_ = kNever;
    if (recent_ && !goes_on) end_ = clock + ticks_;
    return recent_ ? full_ : asked;
  }
  void over() { end_ = kNever; }
  // The board may not have heard the last words. Whether they were about a kick: then the fan is to
  // be told at once what it was asked for, and nobody knows what it has.
  bool interrupt() {
    if (recent_) end_ = 0;
    return recent_;
  }
  void forget() { recent_ = false, end_ = kNever; }

 private:
  Ticks ticks_ = 0, end_ = kNever;
  uint32_t full_ = 0, rise_ = 0, asked_ = 0;
  bool recent_ = false;  // the last words were about a kick
};

}  // namespace passo::wire
