// The planned stop of the machine on its path from a given clock. Boards get this plan in advance,
// in case their link fails.
#pragma once
#include <cstdint>
#include <vector>

#include "plan/history.hpp"
#include "plan/move.hpp"
#include "plan/planner.hpp"

namespace passo {

// Sets `moves` to the stop from `clock` on, along the moves in `history` and in the planner's
// queue.
void brake_from(int64_t clock, const History& history, const Planner& planner, double hz,
                std::vector<Move>& moves);

}  // namespace passo
