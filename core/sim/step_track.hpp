// A motor's position from its executed steps, which arrive in advance and are made up to a clock.
#pragma once
#include <algorithm>
#include <deque>
#include <vector>

#include "base/types.hpp"
#include "sim/simulated_device.hpp"

namespace passo::wire {

// A motor as the main board's clock sees it.
struct TrackedMotor {
  double per_step;  // mm or degrees; negative if its steps count down
  double ratio;     // ticks of the main board in one of its own
  double offset;    // clock of the main board when its own reads 0
};

class StepTrack {
 public:
  explicit StepTrack(const TrackedMotor& motor) : motor_(motor) {}

  double position = 0;  // after the last step made

  // Forgets the steps that are not made yet.
  void restart(double from) {
    position = from;
    ahead_.clear();
    done_ = 0;
    next_ = kInfinity;
  }
  double own_clock(double clock) const { return (clock - motor_.offset) / motor_.ratio; }
  double main_clock(Ticks own) const { return double(own) * motor_.ratio + motor_.offset; }
  // In the order of time.
  void add(const std::vector<StepRun>& runs) {
    ahead_.insert(ahead_.end(), runs.begin(), runs.end());
    if (next_ == kInfinity) find_next();
  }
  // The main board's clock of the next step; infinite if none is known.
  double next() const { return next_; }
  // Makes the next step, and returns by how much it moves.
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
  std::deque<StepRun> ahead_;  // the first run may be made in part
  int64_t done_ = 0;           // of the first run
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
