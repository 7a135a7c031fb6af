// A shift of all that is still to come along X, Y or Z, let into moves under way: a babystep.
#pragma once
#include <algorithm>
#include <cmath>
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
  double apply(std::vector<Move>& moves, int j, double mm) {
    std::vector<Move> out;
    double done = 0;
    for (Move& m : moves) {
      m.p0[j] += done;
      m.p1[j] += done;
      if (done == mm || !m.cartesian)
        out.push_back(m);
      else
        lean(m, j, mm, done, out);
    }
    moves.swap(out);
    return mm - done;
  }

 private:
  static constexpr double kSteepest = 0.05, kGentlest = 0.001;  // mm of shift for a mm of way
  static constexpr double kEqual = 1 - 1e-9;

  const Bounds& bounds_;
  const JunctionRule& junction_;
  const RuleBook& rules_;

  static double way(const Move& m) {
    double mm2 = 0;
    for (int i = 0; i < 3; ++i) mm2 += (m.p1[i] - m.p0[i]) * (m.p1[i] - m.p0[i]);
    return std::sqrt(mm2);
  }

  // Appends m, leaning as steeply as costs next to no speed; adds to `done`.
  void lean(const Move& m, int j, double mm, double& done, std::vector<Move>& out) {
    const Rules& rules = rules_.of(m.rules);
    double slope = kSteepest;
    Move leaning = m;
    for (;; slope *= 0.5) {
      if (slope < kGentlest) return out.push_back(m);
      leaning = m;
      leaning.p1[j] += std::copysign(slope * way(m), mm);
      bounds_.apply(leaning, rules);
      double least2 = kEqual * m.vn2;
      if (leaning.d >= kEqual * m.d && leaning.a >= kEqual * m.a && leaning.vn2 >= least2 &&
          junction_.cap2(m, leaning, rules) >= least2)
        break;
    }
    double room = slope * way(m), wanted = mm - done;
    out.push_back(m);
    if (std::fabs(wanted) >= room) {
      done += std::copysign(room, mm);
      out.back().p1[j] += std::copysign(room, mm);
      return;
    }
    Move behind = m;
    split(m, std::fabs(wanted) / room, out.back(), behind);
    out.back().p1[j] += wanted;
    behind.p0[j] += wanted;
    behind.p1[j] += wanted;
    done = mm;
    out.push_back(behind);
  }

  // The corner between the parts is gentle enough: no junction law there.
  static void split(const Move& m, double part, Move& before, Move& behind) {
    Bounds::cut(m, 0, part, before);
    Bounds::cut(m, part, 1, behind);
    behind.inner = true;
    behind.records = 0;
  }
};

}  // namespace passo
