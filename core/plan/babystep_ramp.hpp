// A babystep: planned moves shift along X, Y or Z, and the first of them approach the shifted path
// by a small slope.
#pragma once
#include <vector>

#include "plan/bounds.hpp"
#include "plan/junction.hpp"
#include "plan/move.hpp"

namespace passo {

// Moves lean by a small slope until the full offset is reached. A move does not lean if it would
// have to be slower for it, or would become shorter: its braking distance might not suffice then.
class Shift {
 public:
  Shift(const Bounds& bounds, const JunctionRule& junction, const RuleBook& rules)
      : bounds_(bounds), junction_(junction), rules_(rules) {}

  // Shifts `moves` by `mm` along slot j. None of them may start above its nominal speed. Returns
  // the mm for which they have no room.
  double apply(std::vector<Move>& moves, int j, double mm);

 private:
  static constexpr double kMaxSlope = 0.05, kMinSlope = 0.001;  // mm of shift for a mm of path
  static constexpr double kEqual = 1 - 1e-9;

  const Bounds& bounds_;
  const JunctionRule& junction_;
  const RuleBook& rules_;

  static double distance(const Move& m);

  // Appends m with the steepest slope that costs almost no speed; adds its shift to `done`.
  void lean(const Move& m, int j, double mm, double& done, std::vector<Move>& out);

  // Splits m at the fraction `part` of its length. No junction law applies between the parts: the
  // corner is that small.
  static void split(const Move& m, double part, Move& before, Move& after);
};

}  // namespace passo
