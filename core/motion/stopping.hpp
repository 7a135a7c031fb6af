// How the machine would stop on its path from a clock on: what boards are told in case that nobody
// tells them how to go on.
#pragma once
#include <cstdint>
#include <vector>

#include "plan/history.hpp"
#include "plan/move.hpp"
#include "plan/planner.hpp"

namespace passo {

// Puts into `moves` the way to a stop from `clock` on, planned: of the moves that have been planned
// up to there, and of those that the planner still has.
void brake_from(int64_t clock, const History& history, const Planner& planner, double hz,
                std::vector<Move>& moves);

}  // namespace passo
