// The part of a plan that a controlled stop has suspended.
#pragma once
#include <cstdint>
#include <deque>
#include <vector>

#include "plan/move.hpp"

namespace passo {

// A value for an output, or a mark of the host, with a time relative to moves.
struct Record {
  uint16_t target;
  uint32_t value;
  int64_t clock;
  bool without_move = false;  // it belongs to no move, but came after the last one
};

struct HeldPlan {
  std::vector<Move> moves;
  std::deque<Record>
      records;  // due at the starts of moves; the last `at_end` records are due after all moves
  uint32_t at_end = 0;

  // Inserts moves before the held ones, with the records that are due at their starts, and `after`
  // more records that are due after them.
  void put_first(const std::vector<Move>& rest, std::deque<Record>& of_rest, uint32_t after);
  // Inserts records that are due first.
  void record_first(const std::deque<Record>& first);
  // Moves the first n records to `plan`.
  void give_back(uint32_t n, std::deque<Record>& plan);
  // Shifts all moves by `mm` along slot j (X, Y or Z).
  void shift(int j, double mm);
  // The same. The plan then starts with a move from the position before the shift.
  void shift_from_rest(int j, double mm);

 private:
  uint32_t& first_due() { return moves.empty() ? at_end : moves.front().records; }
};

}  // namespace passo
