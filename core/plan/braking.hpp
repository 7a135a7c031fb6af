// How the machine comes to a stop on its path, each move by its own deceleration.
#pragma once
#include <vector>

#include "plan/move.hpp"

namespace passo {

// Appends to `braking` the part of a move on which the machine brakes from speed² v2, or all of the
// move, and reduces v2 accordingly. True if the machine stops within the move; then `m` is the rest
// of it.
bool brake(Move& m, double& v2, std::vector<Move>& braking);

// Removes from `rest`, and returns, the moves on which the machine stops from speed² v2, or all of
// them: each with its own deceleration, or all with `even`.
std::vector<Move> take_braking(std::vector<Move>& rest, double v2, double even = 0);

double length_of(const std::vector<Move>& moves);

// Plans the moves of brake() as one deceleration to the stop, from `clock` on.
void plan_braking(std::vector<Move>& moves, double clock, double clock_hz);

}  // namespace passo
