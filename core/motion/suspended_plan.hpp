// What a stop on the path has left of a plan.
#pragma once
#include <cstdint>
#include <deque>
#include <vector>

#include "plan/move.hpp"

namespace passo {

// A value for an output or a mark of the host, timed by the moves around it.
struct Record {
  uint16_t target;
  uint32_t value;
  int64_t clock;
  bool alone = false;  // no move has brought it: it came behind one
};

struct Held {
  std::vector<Move> moves;
  std::deque<Record> records;  // due at their starts, in their order, and then `behind` them all
  uint32_t behind = 0;

  // These come before what is held already: moves, the records due at their starts, and `at_end`
  // more that are due behind them.
  void put_first(const std::vector<Move>& rest, std::deque<Record>& of_rest, uint32_t at_end);
  // These come when it goes on, before all else.
  void record_first(const std::deque<Record>& first);
  // The first n records come in the plan.
  void give_back(uint32_t n, std::deque<Record>& plan);
  // All of it lies `mm` further along slot j (X, Y or Z).
  void shift(int j, double mm);
  // The same, from a machine that stands where it is to go on: it goes over to there first.
  void shift_from_rest(int j, double mm);

 private:
  uint32_t& due_first() { return moves.empty() ? behind : moves.front().records; }
};

}  // namespace passo
