// Messages of the timeline → messages in the clock of one further board.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <vector>

#include "compressor.hpp"
#include "message_queue.hpp"
#include "stabbing.hpp"
#include "time_map.hpp"

namespace passo::wire {

// Step k of a message is due at a tick of the main board's clock; here it gets the one of its own
// board's at that instant, rounded within a window as a compressor does. A message becomes one or
// several.
class Retimer {
 public:
  // How close steps of a motor may come, in ticks of this board: of one direction, and where it
  // turns.
  struct Apart {
    double least = 1, turning = 1;
  };

  explicit Retimer(double tolerance) : tolerance_(tolerance) {}

  TimeMap& map() { return map_; }
  void set_apart(size_t stepper, Apart apart) {
    if (motors_.size() <= stepper) motors_.resize(stepper + 1);
    motors_[stepper].apart = apart;
  }
  // The job begins; a tick of its clock is `ratio` ticks here, nominally.
  void start(double job_hz, double ratio) {
    map_.start(job_hz, ratio);
    for (Motor& motor : motors_) motor = {motor.apart, 0, false};
    ready_.clear();
  }
  int64_t clock_of(int64_t clock) const {
    return int64_t(std::floor(map_.at(double(clock)) + 0.5));
  }

  // What the board is to be sent for the messages taken so far.
  MessageQueue& ready() { return ready_; }

  void retime(const Message& m) {
    map_.use(double(m.end_clock));
    if (m.kind == MessageKind::queue_step) return steps(m);
    Message mapped = m;
    mapped.clock = mapped.end_clock = clock_of(m.clock);
    if (m.kind == MessageKind::set_dir) motors_[m.target].turning = true;
    if (m.kind == MessageKind::reset_clock) motors_[m.target].last = mapped.clock;
    ready_.push(mapped);
  }

 private:
  struct Motor {
    Apart apart;
    int64_t last = 0;  // of the last step
    bool turning = false;
  };

  double tolerance_;
  TimeMap map_;
  std::vector<Motor> motors_;
  MessageQueue ready_;
  Stabbing stabbing_;
  std::vector<double> times_, lo_, hi_, executed_;

  void steps(const Message& m) {
    Motor& motor = motors_[m.target];
    const int64_t count = m.count;
    const int64_t start =
        m.end_clock - int64_t(m.interval) * count - int64_t(m.add) * (count * (count - 1) / 2);
    if (map_.whole() && motor.last == clock_of(start)) {
      Message same = m;
      same.clock = clock_of(m.clock);
      same.end_clock = motor.last = clock_of(m.end_clock);
      motor.turning = false;
      return ready_.push(same);
    }
    const size_t n = size_t(count);
    if (times_.size() < n + 8)
      for (auto* v : {&times_, &lo_, &hi_, &executed_}) v->resize(2 * (n + 8));
    // Steps that the rounding of the one before has come too close to are late by as much.
    double* t = times_.data() + 1;
    double apart = motor.turning ? motor.apart.turning : motor.apart.least;
    t[-1] = double(motor.last);
    int64_t at = start, interval = m.interval;
    for (size_t k = 0; k < n; ++k) {
      at += interval;
      interval += m.add;
      t[k] = std::max(map_.at(double(at)), t[k - 1] + apart);
      apart = motor.apart.least;
    }
    t[n] = t[n - 1] + 1e15;
    windows(t, lo_.data(), hi_.data(), int(n), tolerance_, motor.apart.least);
    if (motor.turning) lo_[0] = std::max(lo_[0], double(motor.last) + motor.apart.turning - 0.5);
    motor.turning = false;
    int64_t due = clock_of(m.clock);
    for (size_t i = 0; i < n;) {
      Command c = stabbing_.longest(&lo_[i], &hi_[i], int(std::min(n - i, size_t(kMostSteps))),
                                    double(motor.last), &executed_[i]);
      int64_t ticks = int64_t(c.interval), add = int64_t(c.add), many = c.count;
      if (ticks < 1 || ticks + add * (many - 1) < 1 || ticks > 0x7fffffff)
        throw std::logic_error("a command without time between its steps");
      int64_t clock = std::max(due, motor.last);
      motor.last += ticks * many + add * (many * (many - 1) / 2);
      ready_.push({clock, motor.last, uint32_t(ticks), uint16_t(many), int16_t(add), m.target,
                   MessageKind::queue_step, m.dir});
      i += size_t(many);
    }
  }
};

}  // namespace passo::wire
