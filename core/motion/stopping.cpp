#include "motion/stopping.hpp"

#include "plan/bounds.hpp"
#include "plan/braking.hpp"

namespace passo {

void brake_from(int64_t clock, const History& history, const Planner& planner, double hz,
                std::vector<Move>& moves) {
  auto under_way = history.at(double(clock));
  double v2 = planner.speed2();
  auto next = [&](const Move& m) {
    Move copy = m;
    if (v2 > 0) brake(copy, v2, moves);
    return v2 > 0;
  };
  bool goes_on = true;
  if (under_way != history.end()) {
    const Move& m = *under_way;
    if (m.kind == MoveKind::dwell || m.start >= double(clock)) {
      v2 = m.v0 * m.v0;
      goes_on = m.kind != MoveKind::dwell && next(m);
    } else {
      auto [s, v] = m.along(double(clock) - m.start, hz);
      v2 = v * v;
      Move left = m;
      Bounds::cut(m, s / m.d, 1, left);
      goes_on = next(left);
    }
    for (++under_way; goes_on && under_way != history.end(); ++under_way)
      goes_on = next(*under_way);
  }
  if (goes_on) planner.all_queued(next);
  plan_braking(moves, double(clock), hz);
}

}  // namespace passo
