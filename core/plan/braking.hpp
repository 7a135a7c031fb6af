// How the machine comes to a stop on its path, each move by its own deceleration.
#pragma once
#include <vector>

#include "plan/move.hpp"

namespace passo {

// Puts into `braking` the part of a move in which the machine comes to a stop from speed² v2, or
// all of it, and takes what that costs from v2. True if a part of the move is left, which is `m`
// then.
bool brake(Move& m, double& v2, std::vector<Move>& braking);

// Takes from `rest` the moves on which the machine comes to a stop from speed² v2, or all of them;
// each by its own deceleration, or all by `even`.
std::vector<Move> take_braking(std::vector<Move>& rest, double v2, double even = 0);

double length_of(const std::vector<Move>& moves);

// Plans what brake() has found: one deceleration to the stop, from `clock` on.
void plan_braking(std::vector<Move>& moves, double clock, double clock_hz);

}  // namespace passo
