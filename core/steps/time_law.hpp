// The time at a position on the path of a move. Only the step solver includes these kernels.
#pragma once
#include <algorithm>
#include <cmath>

#include "base/simd.hpp"
#include "plan/move.hpp"

namespace passo {

// t[j] = base + sign * sqrt(c0 + c1 * j)
PASSO_SIMD inline void fill_root(double* __restrict t, int n, double c0, double c1, double base,
                                 double sign) {
  for (int j = 0; j < in_fours(n); ++j) t[j] = base + sign * std::sqrt(std::max(0.0, c0 + c1 * j));
}
PASSO_SIMD inline void fill_line(double* __restrict t, int n, double c0, double c1) {
  for (int j = 0; j < in_fours(n); ++j) t[j] = c0 + c1 * j;
}
// The same for path positions s[j] with uneven distances.
PASSO_SIMD inline void fill_root_at(double* __restrict t, const double* __restrict s, int n,
                                    double c0, double c1, double base, double sign) {
  for (int j = 0; j < in_fours(n); ++j)
    t[j] = base + sign * std::sqrt(std::max(0.0, c0 + c1 * s[j]));
}
PASSO_SIMD inline void fill_line_at(double* __restrict t, const double* __restrict s, int n,
                                    double c0, double c1) {
  for (int j = 0; j < in_fours(n); ++j) t[j] = c0 + c1 * s[j];
}
// Number of values below the limit.
PASSO_SIMD inline int count_below(double limit, const double* s, int n) {
  int below = 0;
  for (int j = 0; j < n; ++j) below += s[j] < limit;
  return below;
}

// The time t(s) of a move: base + sign*sqrt(c0 + c1*s) in each phase, and a line while cruising.
struct TimeLaw {
  double base0, sign0, c00, c01;  // first phase, s < s1
  double line0, line1;            // cruise, s < s2
  double base2, c20, c21;  // last phase, measured from its end, so that a speed near 0 is harmless
  double s1, s2;

  TimeLaw(const Move& m, double hz) {
    double w0 = hz / m.a, w2 = hz / m.b;
    base0 = m.start - m.v0 * w0;
    sign0 = m.a > 0 ? 1 : -1;
    c00 = (m.v0 * w0) * (m.v0 * w0);
    c01 = 2 * w0 * hz;
    s1 = m.d_acc;
    s2 = m.d_acc + m.d_cru;
    double per = m.vc > 0 ? hz / m.vc : 0;
    line1 = per;
    line0 = m.start + m.t_acc - m.d_acc * per;
    base2 = m.end() + m.v1 * w2;
    c20 = (m.v1 * w2) * (m.v1 * w2) + 2 * w2 * hz * m.d;
    c21 = -2 * w2 * hz;
  }

  // n positions s0 + ds*j, ascending. Here and below, `t` and `s` must have space for three more
  // elements, which are read and overwritten.
  void even(double s0, double ds, int n, double* t) const {
    int n1 = below(s1, s0, ds, n), n2 = below(s2, s0, ds, n);
    if (n1 > 0) fill_root(t, n1, c00 + c01 * s0, c01 * ds, base0, sign0);
    if (n2 > n1) fill_line(t + n1, n2 - n1, line0 + line1 * (s0 + n1 * ds), line1 * ds);
    if (n > n2) fill_root(t + n2, n - n2, c20 + c21 * (s0 + n2 * ds), c21 * ds, base2, -1);
  }
  // n ascending positions, at least one.
  void at(const double* s, int n, double* t) const {
    const int n1 = number_below(s1, s, n), n2 = std::max(n1, number_below(s2, s, n));
    if (n1 > 0) fill_root_at(t, s, n1, c00, c01, base0, sign0);
    if (n2 > n1) fill_line_at(t + n1, s + n1, n2 - n1, line0, line1);
    if (n > n2) fill_root_at(t + n2, s + n2, n - n2, c20, c21, base2, -1);
  }

 private:
  // For at least one ascending position. n is usually small and hard to predict, so a search would
  // cost more branches.
  static int number_below(double limit, const double* s, int n) {
    if (limit <= s[0]) return 0;
    if (limit > s[n - 1]) return n;
    return count_below(limit, s, n);
  }
  static int below(double limit, double s0, double ds, int n) {
    double k = (limit - s0) / ds;
    return k <= 0 ? 0 : k >= n ? n : int(std::ceil(k));
  }
};

}  // namespace passo
