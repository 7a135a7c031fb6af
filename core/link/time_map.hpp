// Converts the machine's timeline to the clock of one further board.
#pragma once
#include <algorithm>
#include <cmath>
#include <deque>

namespace passo::wire {

// A chain of straight lines. Each begins at the end of the line before it, so the mapped time never
// jumps. It ends one second later at the clock then expected of the board, so an error of the
// estimate is corrected within a second. Maps ticks of the main board's clock to ticks of the other
// board's clock, both since the job began.
class TimeMap {
 public:
  // One of the job's ticks is `ratio` of the board's, nominally.
  void start(double hz, double ratio) {
    hz_ = hz;
    pieces_.assign(1, {0, 0, ratio});
    used_ = 0;
  }
  double hz() const { return hz_; }
  // The chain is in use up to `t`.
  void use(double t) { used_ = std::max(used_, t); }
  double at(double t) const {
    size_t i = pieces_.size() - 1;
    while (i > 0 && t < pieces_[i].from) --i;
    const Piece& p = pieces_[i];
    return p.value + (t - p.from) * p.rate;
  }
  // The job's tick at which the board's clock reads `value`, by the last line.
  double inverse(double value) const {
    const Piece& p = pieces_.back();
    return p.from + (value - p.value) / p.rate;
  }
  // True if both clocks have exactly the nominal ratio: then no step is rounded.
  bool whole() const {
    return std::all_of(pieces_.begin(), pieces_.end(), [](const Piece& p) { return p.rate == 1; });
  }
  // From `now` on, and after all times in use, the board's clock is expected to be `expected(t)`.
  template <class Expected>
  void renew(double now, Expected&& expected) {
    double from = std::ceil(std::max(now, used_)), value = at(from), until = from + hz_;
    pieces_.push_back({from, value, (expected(until) - value) / hz_});
    if (pieces_.size() > kKept) pieces_.pop_front();
  }
  // From `now` on no time is in use: the chain restarts at the expected clock of the board.
  template <class Expected>
  void restart(double now, Expected&& expected) {
    double from = std::ceil(now), value = expected(from);
    pieces_.assign(1, {from, value, (expected(from + hz_) - value) / hz_});
    used_ = from;
  }

 private:
  static constexpr size_t kKept = 4;
  struct Piece {
    double from, value, rate;
  };
  std::deque<Piece> pieces_;
  double hz_ = 1, used_ = 0;
};

}  // namespace passo::wire
