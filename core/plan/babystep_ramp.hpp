// A shift of all that is still to come along X, Y or Z, let into moves under way: a babystep.
#pragma once
#include <vector>

#include "plan/bounds.hpp"
#include "plan/junction.hpp"
#include "plan/move.hpp"

namespace passo {

// Moves follow their own path until the shift begins, then lean towards it by a small slope until
// they are as far beside it as they shall be. A move that would have to be slower for it, or would
// become shorter, so that the way to brake might not suffice, does not lean.
class Shift {
 public:
  Shift(const Bounds& bounds, const JunctionRule& junction, const RuleBook& rules)
      : bounds_(bounds), junction_(junction), rules_(rules) {}

  // Shifts `moves`, none of which is begun faster than it shall be, by `mm` along slot j. Returns
  // what did not find room in them.
  double apply(std::vector<Move>& moves, int j, double mm);

 private:
  static constexpr double kSteepest = 0.05, kGentlest = 0.001;  // mm of shift for a mm of way
  static constexpr double kEqual = 1 - 1e-9;

  const Bounds& bounds_;
  const JunctionRule& junction_;
  const RuleBook& rules_;

  static double way(const Move& m);

  // Appends m, leaning as steeply as costs next to no speed; adds to `done`.
  void lean(const Move& m, int j, double mm, double& done, std::vector<Move>& out);

  // The corner between the parts is gentle enough: no junction law there.
  static void split(const Move& m, double part, Move& before, Move& behind);
};

}  // namespace passo
