// Moves whose steps are known, as far back as they may be asked for or cut.
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
  // What ended before `past` will not be cut any more.
  void forget(double past);
  bool empty() const { return begin_ == moves_.size(); }
  const Move& oldest() const { return moves_[begin_]; }
  // The move that is under way at a clock, or else the next one; end() if there is none.
  std::vector<Move>::const_iterator at(double clock) const;
  std::vector<Move>::const_iterator end() const { return moves_.end(); }
  const Move* last() const { return moves_.empty() ? nullptr : &moves_.back(); }
  // Where the machine was at a clock, and is going if it stood before its next move; nothing if
  // that is not known any more. `planned_to`: where it goes on from behind all moves.
  std::optional<std::array<double, kAxes>> position_at(double clock,
                                                       const double* planned_to) const;

  // Takes back what comes after `clock`; a move that is under way stays and is returned too.
  std::vector<Move> cut(double clock);
  // Divides a move that is under way at `clock`: the first part is added, and returned; `m` is what
  // is left of it, and `speed2` the speed² in between.
  const Move& divide(Move& m, double clock, double& speed2);

 private:
  double hz_;
  std::vector<Move> moves_;
  size_t begin_ = 0;          // moves before it are forgotten
  double gone_ = -kInfinity;  // clock at which the last of them has ended
};

}  // namespace passo
