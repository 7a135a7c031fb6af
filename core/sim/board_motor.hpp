// A stepper of the virtual board. A command is executed as a whole, in closed form. Step k of a
// command (interval, count, add), k = 1…count, is due at start + k*interval + add*k*(k-1)/2, where
// `start` is the clock of the step before the command.
#pragma once
#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "sim/board_protocol.hpp"
#include "sim/simulated_device.hpp"

namespace passo::wire {

class BoardMotor {
 public:
  uint32_t step_pin = 0, dir_pin = 0;
  int64_t trsync = -1;  // object that stops this motor; -1: none

  BoardMotor(uint32_t step, uint32_t dir) : step_pin(step), dir_pin(dir), ring_(64) {}

  // Throws Shutdown in the cases in which a real board shuts down.
  void queue(Ticks now, uint32_t interval, uint16_t count, int16_t add) {
    if (count == 0) throw Shutdown{Fault::count_zero};
    if (stopped_) return;  // commands are ignored until reset_clock()
    int64_t n = count;
    StepRun run{last_, 0, interval, count, add, next_dir_};
    run.end = run.at(n);
    Ticks first = last_ + int64_t(interval);
    if (last_ <= now) {  // the motor is idle: the first step must be in the future
      if (first < now)
        throw Shutdown{now - first > late_ ? Fault::step_too_late : Fault::timer_too_close};
    }
    if (int64_t(interval) + add * (n - 1) < 0) throw Shutdown{Fault::step_too_late};
    if (tail_ - head_ == ring_.size()) {
      retire(now);
      if (tail_ - head_ == ring_.size()) grow();
    }
    ring_[tail_++ & (ring_.size() - 1)] = run;
    last_ = run.end;
  }
  void set_direction(bool forward) { next_dir_ = forward ? 1 : -1; }
  void reset_clock(Ticks now, Ticks clock) {
    if (last_ > now && head_ != tail_) throw Shutdown{Fault::stepper_active};
    retire(now);
    last_ = clock;
    stopped_ = false;
  }

  // Counts the commands that are finished. The first of the others is in execution; the rest wait
  // in the move queue.
  void retire(Ticks now) {
    while (head_ != tail_) {
      const StepRun& run = front();
      if (run.end > now) break;
      count(run);
      ++head_;
    }
  }
  size_t slots(Ticks now) {
    retire(now);
    return tail_ - head_ > 1 ? tail_ - head_ - 1 : 0;
  }
  // Stops at once. Commands are ignored until reset_clock().
  void stop(Ticks now) {
    retire(now);
    if (head_ != tail_) {
      StepRun run = front();
      run.count = uint16_t(run.done(now));
      run.end = run.at(run.count);
      if (run.count > 0) count(run);
    }
    head_ = tail_;
    if (following_) followed_to_ = {tail_, 0};
    last_ = std::min(last_, now);
    next_dir_ = -1;
    stopped_ = true;
  }

  // Steps forward minus steps backward. `clock` must not be before that of an earlier call of any
  // method.
  int64_t net_at(Ticks clock) {
    retire(clock);
    if (head_ == tail_) return net_;
    const StepRun& run = front();
    return net_ + run.dir * run.done(clock);
  }
  // All steps, forward and backward, under the same condition.
  int64_t steps_at(Ticks clock) {
    retire(clock);
    return steps_ + (head_ == tail_ ? 0 : front().done(clock));
  }

  // Keeps commands that are executed between `from` and `to`.
  void trace(Ticks from, Ticks to) {
    trace_from_ = from;
    trace_to_ = to;
  }
  std::vector<StepRun>& traced() { return trace_; }

  // Starts or stops keeping steps that are executed after `now`, for take_followed().
  void follow(Ticks now, bool on) {
    retire(now);
    following_ = on;
    followed_.clear();
    followed_to_ = {head_, head_ == tail_ ? 0 : front().done(now)};
  }
  // Steps from the last call up to `until`. Commands are not retired here, because later commands
  // may still be stopped.
  std::vector<StepRun> take_followed(Ticks until) {
    std::vector<StepRun> taken = std::exchange(followed_, {});
    for (; following_ && followed_to_.index != tail_; followed_to_ = {followed_to_.index + 1, 0}) {
      const StepRun& run = ring_[followed_to_.index & (ring_.size() - 1)];
      const int64_t done = run.end <= until ? run.count : run.done(until);
      if (done > followed_to_.done) taken.push_back(run.part(followed_to_.done, done));
      if (done < run.count) {
        followed_to_.done = std::max(followed_to_.done, done);
        break;
      }
    }
    return taken;
  }
  void set_late_limit(Ticks ticks) { late_ = ticks; }

 private:
  std::vector<StepRun> ring_;  // size is a power of two
  size_t head_ = 0, tail_ = 0;
  Ticks last_ = 0;  // clock of the last step queued
  Ticks late_ = 0;  // a step that is later than this is "too far in past"
  int64_t net_ = 0, steps_ = 0;
  int8_t next_dir_ = -1;
  bool stopped_ = false;
  Ticks trace_from_ = kNever, trace_to_ = kNever;
  std::vector<StepRun> trace_;
  bool following_ = false;
  struct {
    size_t index = 0;  // of a command in the ring, at or after head_
    int64_t done = 0;  // number of its steps that were taken
  } followed_to_;
  std::vector<StepRun> followed_;

  const StepRun& front() const { return ring_[head_ & (ring_.size() - 1)]; }
  // Counts the command at head_, or the part that was executed before a stop.
  void count(const StepRun& run) {
    if (following_ && followed_to_.index == head_) {
      if (run.count > followed_to_.done)
        followed_.push_back(run.part(followed_to_.done, run.count));
      followed_to_ = {head_ + 1, 0};
    }
    net_ += run.dir * int64_t(run.count);
    steps_ += run.count;
    if (run.end >= trace_from_ && run.start < trace_to_) trace_.push_back(run);
  }
  void grow() {
    std::vector<StepRun> bigger(ring_.size() * 2);
    for (size_t i = head_; i != tail_; ++i)
      bigger[i & (bigger.size() - 1)] = ring_[i & (ring_.size() - 1)];
    ring_.swap(bigger);
  }
};

}  // namespace passo::wire
