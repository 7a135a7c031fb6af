// Outputs, analog inputs, endstops and trigger groups of the virtual board.
#pragma once
#include <algorithm>
#include <cstdint>
#include <deque>
#include <utility>
#include <vector>

#include "sim/board_protocol.hpp"
#include "sim/simulated_device.hpp"

namespace passo::wire {

// A PWM output, or a digital output that may have software PWM: then the value is the on time of
// each cycle in ticks.
class BoardOutput {
 public:
  BoardOutput(uint32_t pin, bool pwm, uint32_t full, uint32_t value, uint32_t default_value,
              Ticks max_duration)
      : pin_(pin), pwm_(pwm), full_(full), default_(default_value), max_duration_(max_duration),
        value_(value) {}

  uint32_t pin() const { return pin_; }
  bool is_pwm() const { return pwm_; }
  uint32_t value() const { return value_; }
  size_t slots() const { return queue_.size(); }
  // Sets the cycle of software PWM, while no value is queued.
  void set_cycle(uint32_t ticks) {
    if (!queue_.empty()) throw Shutdown{Fault::output_queue_busy};
    if (value_ == full_)
      value_ = ticks;  // an output that is on keeps its state until the next value
    default_ = default_ ? ticks : 0;
    full_ = ticks;
  }

  void queue(Ticks now, Ticks clock, uint32_t value) {
    if (clock < now) throw Shutdown{Fault::timer_too_close};
    queue_.push_back({clock, std::min(value, full_)});
  }
  void update(Ticks now, bool on, Plant& plant) {
    if (!queue_.empty()) throw Shutdown{Fault::output_queue_busy};
    set(now, on ? full_ : 0, plant);
  }
  Ticks next() const { return std::min(expires_, queue_.empty() ? kNever : queue_.front().clock); }
  void run(Ticks now, Plant& plant) {
    while (!queue_.empty() && queue_.front().clock <= std::min(now, expires_)) {
      PinChange change = queue_.front();
      queue_.pop_front();
      set(change.clock, change.value, plant);
    }
    if (expires_ <= now) throw Shutdown{pwm_ ? Fault::missed_pwm : Fault::missed_digital};
  }
  void shut_down(Ticks now, Plant& plant) {
    queue_.clear();
    set(now, default_, plant);
    expires_ = kNever;
  }

  void trace() { tracing_ = true; }
  std::vector<PinChange>& traced() { return trace_; }

 private:
  uint32_t pin_;
  bool pwm_;
  uint32_t full_, default_;
  Ticks max_duration_;
  uint32_t value_;
  Ticks expires_ = kNever;  // a value other than the default must be renewed before this clock
  std::deque<PinChange> queue_;
  bool tracing_ = false;
  std::vector<PinChange> trace_;

  void set(Ticks clock, uint32_t value, Plant& plant) {
    expires_ = max_duration_ > 0 && value != default_ ? clock + max_duration_ : kNever;
    if (tracing_ && value != value_) trace_.push_back({clock, value});
    value_ = value;
    plant.set_output(pin_, clock, double(value) / full_);
  }
};

// Every `rest` ticks, takes `count` samples at intervals of `sample` ticks, and reports their sum.
// A fault if `range_checks` sums in a row are outside minimum…maximum.
struct BoardAnalogIn {
  uint32_t pin;
  Ticks begin = kNever, sample = 0, rest = 0;
  uint32_t count = 0, taken = 0, sum = 0, minimum = 0, maximum = 0, range_checks = 0, outside = 0;
  size_t report_size = 0;
  Bytes values;

  explicit BoardAnalogIn(uint32_t pin_) : pin(pin_) {}
  Ticks next() const { return begin == kNever ? kNever : begin + sample * taken; }
  // Takes a sample. After the last one, adds the sum to `values`. Returns true if this sum is the
  // one too many outside the range.
  bool run(Plant& plant) {
    sum += plant.adc(pin, next());
    if (++taken < count) return false;
    uint32_t whole = std::exchange(sum, 0);
    taken = 0;
    begin += rest;
    values.push_back(uint8_t(whole));
    values.push_back(uint8_t(whole >> 8));
    if (whole >= minimum && whole <= maximum) {
      outside = 0;
      return false;
    }
    if (range_checks == 0 || ++outside < range_checks) return false;
    outside = 0;
    return true;
  }
};

// Samples its pin every `rest` ticks. It triggers after `count` equal samples at intervals of
// `sample` ticks.
struct BoardEndstop {
  uint32_t pin;
  bool armed = false, wanted = false;
  Ticks next_sample = 0, sample = 0, rest = 0, first_hit = 0;
  uint32_t count = 0, hits = 0, reason = 0;
  uint32_t trsync = 0;

  explicit BoardEndstop(uint32_t pin_) : pin(pin_) {}
  Ticks next() const { return armed ? next_sample : kNever; }
  // Takes a sample. Returns whether the endstop triggers.
  bool run(bool level) {
    if (level != wanted) {
      next_sample = (hits > 0 ? first_hit : next_sample) + rest;
      hits = 0;
      return false;
    }
    if (hits++ == 0) first_hit = next_sample;
    if (hits < count) {
      next_sample += sample;
      return false;
    }
    armed = false;
    return true;
  }
};

// A group of motors that stop together.
struct BoardTrsync {
  bool armed = false;
  uint32_t reason = 0, expire_reason = 0;
  Ticks report = kNever, report_ticks = 0, timeout = kNever;
  std::vector<size_t> motors;

  Ticks next() const { return std::min(report, timeout); }
};

}  // namespace passo::wire
