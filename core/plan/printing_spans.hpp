// When a plan extrudes along X or Y in one layer.
#pragma once
#include <cstdint>
#include <utility>
#include <vector>

#include "plan/move.hpp"

namespace passo {

class PrintingSpans {
 public:
  explicit PrintingSpans(uint16_t layer) : layer_(layer) {}

  // A settled move, in the order of time; its steps come `delay` ticks later than its plan.
  void add(const Move& move, double delay) {
    if (over_) return;
    over_ = move.layer > layer_;
    const bool along = move.p0[kX] != move.p1[kX] || move.p0[kY] != move.p1[kY];
    if (move.layer != layer_ || move.kind != MoveKind::print || !along) return;
    const double from = move.start + delay, to = move.end() + delay;
    if (!spans_.empty() && from <= spans_.back().to && move.tool == spans_.back().tool)
      spans_.back().to = to;
    else
      spans_.push_back({from, to, move.tool});
  }
  // A move of a later layer has arrived.
  bool over() const { return over_; }
  // Spans in ticks since the start of the job. Moves of a tool without a pause in between are one
  // span.
  struct Span {
    double from, to;
    uint16_t tool;
  };
  std::vector<Span> take() { return std::exchange(spans_, {}); }

 private:
  uint16_t layer_;
  bool over_ = false;
  std::vector<Span> spans_;
};

}  // namespace passo
