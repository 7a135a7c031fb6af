#include "plan/braking.hpp"

#include <algorithm>
#include <cmath>

#include "plan/bounds.hpp"

namespace passo {

bool brake(Move& m, double& v2, std::vector<Move>& braking) {
  double reach = 2 * m.b * m.d, part = v2 / reach;
  if (part < 1 - 1e-9) {
    Move first = m;
    Bounds::cut(m, 0, part, first);
    Move second = m;
    Bounds::cut(m, part, 1, second);
    second.inner = true;
    second.records = 0;
    braking.push_back(first);
    m = second;
    v2 = 0;
    return true;
  }
  braking.push_back(m);
  v2 = part <= 1 ? 0 : v2 - reach;
  return false;
}

std::vector<Move> take_braking(std::vector<Move>& rest, double v2, double even) {
  std::vector<Move> braking;
  size_t i = 0;
  for (; i < rest.size() && v2 > 0; ++i) {
    const double own = rest[i].b;
    if (even > 0) rest[i].b = even;
    if (!brake(rest[i], v2, braking)) continue;
    rest[i].b = own;
    break;
  }
  rest.erase(rest.begin(), rest.begin() + long(i));
  return braking;
}

double length_of(const std::vector<Move>& moves) {
  double length = 0;
  for (const Move& m : moves) length += m.d;
  return length;
}

void plan_braking(std::vector<Move>& moves, double clock, double clock_hz) {
  double v2 = 0;
  for (const Move& m : moves) v2 += 2 * m.b * m.d;
  double v = std::sqrt(v2);
  for (Move& m : moves) {
    m.v0 = m.vc = v;
    m.v1 = v = std::sqrt(std::max(0.0, v * v - 2 * m.b * m.d));
    m.a = m.b;
    m.d_acc = m.d_cru = m.t_acc = m.t_cru = 0;
    m.t_dec = (m.v0 - m.v1) / m.b * clock_hz;
    m.start = clock;
    clock = m.end();
  }
}

}  // namespace passo
