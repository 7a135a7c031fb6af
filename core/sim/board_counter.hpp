// An input of the virtual board whose edges it counts, by polling.
#pragma once
#include <cstdint>

#include "link/device.hpp"

namespace passo::wire {

struct BoardCounter {
  uint32_t pin;
  Ticks due = kNever, poll = 0, sample = 0, report_at = 0, counted_at = 0;
  uint32_t count = 0;
  bool level = false;

  explicit BoardCounter(uint32_t pin_) : pin(pin_) {}
  Ticks next() const { return due; }

  void query(Ticks begin, Ticks poll_ticks, Ticks sample_ticks, bool level_now) {
    due = begin;
    poll = poll_ticks;
    sample = sample_ticks;
    report_at = begin + sample_ticks;
    level = level_now;
  }

  // Takes a sample; true if a report is due, which has the clock of the next one.
  bool run(bool level_now) {
    if (level_now != level) {
      level = level_now;
      ++count;
      counted_at = due;
    }
    bool reports = due >= report_at;
    if (reports) report_at = due + sample;
    due += poll;
    return reports;
  }
};

}  // namespace passo::wire
