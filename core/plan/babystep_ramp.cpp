#include "plan/babystep_ramp.hpp"

#include <cmath>

namespace passo {

double Shift::apply(std::vector<Move>& moves, int j, double mm) {
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

double Shift::distance(const Move& m) {
  double mm2 = 0;
  for (int i = 0; i < 3; ++i) mm2 += (m.p1[i] - m.p0[i]) * (m.p1[i] - m.p0[i]);
  return std::sqrt(mm2);
}

void Shift::lean(const Move& m, int j, double mm, double& done, std::vector<Move>& out) {
  const Rules& rules = rules_.of(m.rules);
  double slope = kMaxSlope;
  Move leaning = m;
  for (;; slope *= 0.5) {
    if (slope < kMinSlope) return out.push_back(m);
    leaning = m;
    leaning.p1[j] += std::copysign(slope * distance(m), mm);
    bounds_.apply(leaning, rules);
    double least2 = kEqual * m.vn2;
    if (leaning.d >= kEqual * m.d && leaning.a >= kEqual * m.a && leaning.vn2 >= least2 &&
        junction_.cap2(m, leaning, rules) >= least2)
      break;
  }
  double room = slope * distance(m), wanted = mm - done;
  out.push_back(m);
  if (std::fabs(wanted) >= room) {
    done += std::copysign(room, mm);
    out.back().p1[j] += std::copysign(room, mm);
    return;
  }
  Move after = m;
  split(m, std::fabs(wanted) / room, out.back(), after);
  out.back().p1[j] += wanted;
  after.p0[j] += wanted;
  after.p1[j] += wanted;
  done = mm;
  out.push_back(after);
}

void Shift::split(const Move& m, double part, Move& before, Move& after) {
  Bounds::cut(m, 0, part, before);
  Bounds::cut(m, part, 1, after);
  after.inner = true;
  after.records = 0;
}

}  // namespace passo
