// Moves whose steps are solved, as long as they may still be read or cut.
#pragma once
#include <array>
#include <optional>
#include <vector>

#include "plan/bounds.hpp"
#include "plan/move.hpp"

namespace passo {

class History {
 public:
  explicit History(double clock_hz) : hz_(clock_hz) {}

  void add(const std::vector<Move>& moves);
  // Drops moves that ended before `past`.
  void forget(double past);
  bool empty() const { return begin_ == moves_.size(); }
  const Move& oldest() const { return moves_[begin_]; }
  // The move that is under way at a clock, or else the next one, or end().
  std::vector<Move>::const_iterator at(double clock) const;
  std::vector<Move>::const_iterator end() const { return moves_.end(); }
  const Move* last() const { return moves_.empty() ? nullptr : &moves_.back(); }
  // The position at a clock; at standstill, the start of the next move. Nothing if the moves at
  // that clock were dropped. `planned_to` is the position after all moves.
  std::optional<std::array<double, kAxes>> position_at(double clock,
                                                       const double* planned_to) const;
  // Net filament of an extruder that the moves push after a clock, mm.
  double filament_after(double clock, size_t extruder) const;

  // The moves that begin before `clock` and end at most `memory` ticks before it.
  std::vector<Move> before(double clock, double memory) const;
  // Removes and returns the moves after `clock`. A move that is under way at `clock` stays, and is
  // the first of the result.
  std::vector<Move> cut(double clock);
  // Divides a move that is under way at `clock`. Adds and returns the first part; `m` becomes the
  // second, and `speed2` the speed² between them.
  const Move& divide(Move& m, double clock, double& speed2);

 private:
  double hz_;
  std::vector<Move> moves_;
  size_t begin_ = 0;          // moves before it are forgotten
  double gone_ = -kInfinity;  // end of the last one of these, ticks
};

}  // namespace passo
