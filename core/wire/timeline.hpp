// What the boards of one machine share: the main board's clock, and the news that one has stopped.
#pragma once
#include <atomic>
#include <mutex>

#include "clock_sync.hpp"

namespace passo::wire {

// Links of one machine meet here, each from a thread of its own where a thread drives it. Nothing
// here waits for a link.
class Timeline {
 public:
  // The main board's clock as its link knows it; host time in ticks of `hz`.
  void set_clock(const ClockLine& line, double hz) {
    std::lock_guard lock(guard_);
    line_ = line;
    hz_ = hz;
  }
  // Host time, in ticks of `hz`, at which the main board's clock reads `clock`.
  double host_at(double clock, double hz) const {
    std::lock_guard lock(guard_);
    return line_.host_at(clock) * (hz / hz_);
  }

  // A board has stopped or is lost: all others stop too.
  void halt() { halted_ = true; }
  bool halted() const { return halted_; }

 private:
  mutable std::mutex guard_;
  ClockLine line_;
  double hz_ = 1;
  std::atomic<bool> halted_{false};
};

}  // namespace passo::wire
