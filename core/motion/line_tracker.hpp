// Tracks from which line and layer of the program each part of the motion comes.
#pragma once
#include <algorithm>
#include <cstdint>
#include <deque>

namespace passo {

class ProgramLines {
 public:
  explicit ProgramLines(double clock_hz) : kept_ticks_(kKeptSeconds * clock_hz) {}

  // A move of this line (0: not of the program) starts at `ticks`. Before the first call of at(),
  // nothing is kept.
  void add(double ticks, uint32_t number, uint32_t layer) {
    if (kept_ && number > 0 && (starts_.empty() || starts_.back().number != number))
      starts_.push_back({ticks, number, layer});
  }
  // Drops lines that start at `ticks` or later: they will not be executed.
  void cut(double ticks) {
    while (!starts_.empty() && starts_.back().ticks >= ticks) starts_.pop_back();
  }
  // A new program starts.
  void forget() { starts_.clear(); }
  // The line of the move at `ticks`, or of the last one before it, or 0. `ticks` must
  // not decrease from call to call.
  uint32_t at(double ticks) {
    kept_ = true;
    while (starts_.size() > 1 && starts_[1].ticks <= ticks - kept_ticks_) starts_.pop_front();
    return starts_.empty() || starts_[0].ticks > ticks ? 0 : near(ticks);
  }
  // The same for any clock that is at most a second before the last at().
  uint32_t near(double ticks) const {
    const Start* start = find(ticks);
    return start ? start->number : 0;
  }
  // The layer of the move of near(); 0 before the first layer.
  uint32_t layer_near(double ticks) const {
    const Start* start = find(ticks);
    return start ? start->layer : 0;
  }

 private:
  static constexpr double kKeptSeconds = 1;
  struct Start {
    double ticks;
    uint32_t number, layer;
  };
  const Start* find(double ticks) const {
    if (starts_.empty()) return nullptr;
    auto next = std::upper_bound(starts_.begin(), starts_.end(), ticks,
                                 [](double t, const Start& line) { return t < line.ticks; });
    return &*(next == starts_.begin() ? next : next - 1);
  }
  double kept_ticks_;
  bool kept_ = false;
  std::deque<Start> starts_;
};

}  // namespace passo
