// The position of a motor from its executed steps, which are added in advance and then made up to a
// clock.
#pragma once
#include <algorithm>
#include <deque>
#include <vector>

#include "base/types.hpp"
#include "sim/simulated_device.hpp"

namespace passo::wire {

// How a motor relates to the clock of the main board.
struct TrackedMotor {
  double per_step;  // mm or degrees; negative if the motor is inverted
  double ratio;     // ticks of the main board per tick of the motor's board
  double offset;    // clock of the main board when the motor's board reads 0
};

class StepTrack {
 public:
  explicit StepTrack(const TrackedMotor& motor) : motor_(motor) {}

  double position = 0;  // after the last step made

  // Restarts at this position. Drops steps that are not made yet.
  void restart(double from) {
    position = from;
    ahead_.clear();
    done_ = 0;
    next_ = kInfinity;
  }
  double own_clock(double clock) const { return (clock - motor_.offset) / motor_.ratio; }
  double main_clock(Ticks own) const { return double(own) * motor_.ratio + motor_.offset; }
  // Adds steps, in the order of their clocks.
  void add(const std::vector<StepRun>& runs) {
    ahead_.insert(ahead_.end(), runs.begin(), runs.end());
    if (next_ == kInfinity) find_next();
  }
  // Main clock of the next step; infinite if none is known.
  double next() const { return next_; }
  // Makes the next step. Returns its distance.
  double step() {
    const double by = ahead_.front().dir * motor_.per_step;
    position += by;
    ++done_;
    find_next();
    return by;
  }
  // Makes all steps up to a clock.
  void run(double clock) {
    while (next_ <= clock) {
      const StepRun& first = ahead_.front();
      const double own = own_clock(clock);
      const int64_t done =
          std::max(double(first.end) <= own ? first.count : first.done(Ticks(own)), done_ + 1);
      position += double(first.dir * (done - done_)) * motor_.per_step;
      done_ = done;
      find_next();
    }
  }

 private:
  TrackedMotor motor_;
  std::deque<StepRun> ahead_;  // the first command may be partly done
  int64_t done_ = 0;           // number of steps of the first command that are made
  double next_ = kInfinity;

  void find_next() {
    while (!ahead_.empty() && done_ >= ahead_.front().count) {
      ahead_.pop_front();
      done_ = 0;
    }
    next_ = ahead_.empty() ? kInfinity : main_clock(ahead_.front().at(done_ + 1));
  }
};

}  // namespace passo::wire
