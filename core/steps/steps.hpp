// The ideal times of one motor's steps, which the solver passes to the compressor.
#pragma once
#include <algorithm>
#include <cstddef>
#include <deque>
#include <vector>

#include "base/uninitialised_vector.hpp"

namespace passo {

// Steps in the order of their times. A run contains steps of one direction.
struct Steps {
  struct Run {
    size_t first;  // index in `ticks`
    int dir;       // +1 or -1
  };
  struct Widening {
    size_t first;      // index in `ticks`
    double tolerance;  // ticks; 0: the board's own
  };
  UnsetDoubles ticks;
  std::vector<Run> runs;
  std::vector<Widening>
      widenings;  // places where the tolerance changes; before the first it is the board's own

  // Returns where to write the ticks of n more steps in direction `dir`. There is space for four
  // more elements: TimeLaw writes up to three after the end, the compressor one.
  double* extend(size_t n, int dir) {
    size_t first = ticks.size(), wanted = first + n + 4;
    if (ticks.capacity() < wanted) ticks.reserve(std::max(wanted, ticks.capacity() * 3 / 2));
    if (runs.empty() || runs.back().dir != dir) runs.push_back({first, dir});
    ticks.resize(first + n);
    return ticks.data() + first;
  }
  // Later steps have this tolerance.
  void set_tolerance(double tolerance) {
    if ((widenings.empty() ? 0 : widenings.back().tolerance) == tolerance) return;
    if (!widenings.empty() && widenings.back().first == ticks.size()) widenings.pop_back();
    widenings.push_back({ticks.size(), tolerance});
  }
  // Moves the changes of tolerance after the n ticks from index `from` on are removed.
  void move_widenings(size_t from, size_t n) {
    for (Widening& w : widenings)
      if (w.first > from) w.first = std::max(w.first - std::min(n, w.first), from);
    while (widenings.size() > 1 && widenings[1].first <= 1) widenings.erase(widenings.begin());
  }
};

// Tolerances by clock, for steps that are not solved move by move.
class TimedTolerances {
 public:
  void add(double ticks, double tolerance) {
    if (tolerance == last_) return;
    changes_.push_back({ticks, last_ = tolerance});
    if (changes_.size() == 1) next_ = ticks;
  }
  // The next steps that go to `out` are due at `ticks` or later.
  void apply(double ticks, Steps& out) {
    if (ticks < next_) [[likely]]
      return;
    for (; !changes_.empty() && changes_.front().ticks <= ticks; changes_.pop_front())
      out.set_tolerance(changes_.front().tolerance);
    next_ = changes_.empty() ? kNever : changes_.front().ticks;
  }

 private:
  struct Change {
    double ticks, tolerance;
  };
  static constexpr double kNever = 1e300;
  std::deque<Change> changes_;
  double last_ = 0, next_ = kNever;
};

}  // namespace passo
