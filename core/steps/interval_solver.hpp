// Step times in intervals in which a motor's position is a quadratic of time, or nearly so.
#pragma once
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "base/simd.hpp"
#include "steps/steps.hpp"

namespace passo {

// Collects a block of intervals in arrays. It calculates the coefficients of four intervals at a
// time, then the steps of each interval, also four at a time. Step k is at the time when the
// position crosses k - 1/2.
//
// Let y be the distance from the slower end of an interval, h half the speed there, and c half the
// acceleration in the direction of the steps. Then the time is y / (h + sqrt(h^2 + c y)). Two other
// forms need no division for each step. Which one applies depends on r = c y / h^2 at the faster
// end:
//   r >= kBent: sqrt(h^2 + c y) / c - h / c; the difference loses a factor of at most 1 / kBent
//   r <  kBent: the series in y up to r^5 (Catalan numbers); its error 132 (r/4)^6 is at most 5e-13
class IntervalSolver {
 public:
  // Starts at clock t and position q, in steps.
  void begin(double t, double q) {
    t_[0] = t, q_[0] = q;
    used_ = 0;
  }
  // Adds an interval from the end of the last one. Speeds are those within the interval. `odd` and
  // `even` bend the quadratic: with x from 0 to 1 and y = x (x - 1), y (odd (x - 1/2) + even y)
  // steps are added. Then the interval has no turn, and the bend is so small that one step of
  // Newton's method is exact enough.
  void add(double t, double q, double speed0, double speed1, double accel, double odd = 0,
           double even = 0) {
    t_[used_ + 1] = t, q_[used_ + 1] = q;
    v0_[used_] = speed0, v1_[used_] = speed1, a_[used_] = accel;
    odd_[used_] = odd, even_[used_] = even;
    if (++used_ == kBlock) flush();
  }
  void flush() {
    if (used_ > 0) flush_all();
  }
  // Sets where the steps go.
  void into(Steps& out, TimedTolerances& tolerances) { out_ = &out, tolerances_ = &tolerances; }
  // Step count at the end of the last interval.
  int64_t count() const { return int64_t(std::floor(q_[used_] + 0.5)); }

 private:
  static constexpr size_t kBlock = 256, kSize = kBlock + 8;
  static constexpr double kBent = 1.0 / 64;

  double t_[kSize], q_[kSize];  // at the start of each interval
  double v0_[kSize], v1_[kSize], a_[kSize], odd_[kSize], even_[kSize];
  double count_[kSize], steps_[kSize], dir_[kSize], y0_[kSize];
  double k_[7][kSize], kind_[kSize];  // kind_: 0 no step, 1 series, 2 root, 3 turn
  size_t used_ = 0;
  Steps* out_ = nullptr;
  TimedTolerances* tolerances_ = nullptr;

  PASSO_SIMD static void prepare(IntervalSolver& s, int n) {
    for (int i = 0; i < in_fours(n + 1); ++i) s.count_[i] = std::floor(s.q_[i] + 0.5);
    for (int i = 0; i < in_fours(n); ++i) {
      const double net = s.count_[i + 1] - s.count_[i], d = net < 0 ? -1.0 : 1.0, steps = net * d;
      const double s0 = std::fabs(s.v0_[i]), s1 = std::fabs(s.v1_[i]);
      const double first = s.count_[i] + 0.5 * d;
      const bool up = s0 <= s1;
      const double slow = up ? s0 : s1, fast = up ? s1 : s0;
      const double base = up ? s.t_[i] : s.t_[i + 1], from = up ? s.q_[i] : s.q_[i + 1];
      const double h = 0.5 * slow, hh = h * h, c = 0.5 * s.a_[i] * d, distance = (first - from) * d;
      const double above = distance > 0 ? distance : 0.0,
                   below = distance < 1 - steps ? distance : 1 - steps;
      const bool bent = fast * fast - slow * slow >= kBent * (slow * slow);
      const double inverse = 1 / (bent ? c : slow), r = c * (inverse * inverse);
      // Root: k0 + k1 sqrt(k2 + k3 y). Series: k0 + y (k1 + y (k2 + ...)).
      const double e2 = -inverse * r, e3 = -2 * e2 * r, e4 = -2.5 * e3 * r, e5 = -2.8 * e4 * r;
      s.y0_[i] = up ? above : below;
      s.steps_[i] = steps;
      s.dir_[i] = d;
      s.k_[0][i] = bent ? base - h * inverse : base;
      s.k_[1][i] = inverse;
      s.k_[2][i] = bent ? hh : e2;
      s.k_[3][i] = bent ? c : e3;
      s.k_[4][i] = e4;
      s.k_[5][i] = e5;
      s.k_[6][i] = -3 * e5 * r;
      const double some = bent ? 2.0 : 1.0, any = steps != 0 ? some : 0.0;
      s.kind_[i] = s.v0_[i] * s.v1_[i] < 0 ? 3.0 : any;
    }
  }
  // Rounding may move a root out of the interval; then the nearer end is used.
  PASSO_SIMD static void series(double* __restrict t, int n, const double* k, double y0, double low,
                                double high) {
    const double k0 = k[0], k1 = k[kSize], k2 = k[2 * kSize], k3 = k[3 * kSize], k4 = k[4 * kSize],
                 k5 = k[5 * kSize], k6 = k[6 * kSize];
    for (int j = 0; j < in_fours(n); ++j) {
      const double y = y0 + j;
      double x = k0 + y * (k1 + y * (k2 + y * (k3 + y * (k4 + y * (k5 + y * k6)))));
      x = x > low ? x : low;
      t[j] = x < high ? x : high;
    }
  }
  PASSO_SIMD static void root(double* __restrict t, int n, const double* k, double y0, double low,
                              double high) {
    const double k0 = k[0], k1 = k[kSize], k2 = k[2 * kSize], k3 = k[3 * kSize];
    for (int j = 0; j < in_fours(n); ++j) {
      const double r = k2 + k3 * (y0 + j);
      double x = k0 + k1 * std::sqrt(r > 0 ? r : 0.0);
      x = x > low ? x : low;
      t[j] = x < high ? x : high;
    }
  }

  PASSO_SIMD static void bend(double* __restrict t, int n, double low, double high, double v0,
                              double v1, double odd, double even) {
    const double per = 1 / (high - low), change = v1 - v0, odd_speed = odd * per,
                 even_speed = 4 * even * per;
    for (int j = 0; j < in_fours(n); ++j) {
      const double x = (t[j] - low) * per, y = x * (x - 1), half = x - 0.5;
      const double speed = v0 + change * x + odd_speed * (3 * y + 0.5) + even_speed * (y * half);
      double to = t[j] - y * (odd * half + even * y) / speed;
      to = to > low ? to : low;
      t[j] = to < high ? to : high;
    }
  }

  void flush_all() {
    for (size_t i = used_; i < size_t(in_fours(int(used_))); ++i) {
      v0_[i] = v1_[i] = a_[i] = 0;
      q_[i + 1] = q_[used_], t_[i + 1] = t_[used_];
    }
    prepare(*this, int(used_));
    for (size_t i = 0; i < used_; ++i) {
      if (kind_[i] == 0) continue;
      tolerances_->apply(t_[i], *out_);
      if (kind_[i] == 3) [[unlikely]] {
        turn(i);
        continue;
      }
      const int steps = int(steps_[i]);
      double* to = out_->extend(size_t(steps), int(dir_[i]));
      (kind_[i] == 1 ? series : root)(to, steps, &k_[0][i], y0_[i], t_[i], t_[i + 1]);
      if ((odd_[i] != 0) | (even_[i] != 0))
        bend(to, steps, t_[i], t_[i + 1], v0_[i], v1_[i], odd_[i], even_[i]);
    }
    t_[0] = t_[used_], q_[0] = q_[used_];
    used_ = 0;
  }

  // An interval with a turn: the steps before the turn, then those after it.
  void turn(size_t i) {
    const double u = -v0_[i] / a_[i], top = q_[i] + 0.5 * v0_[i] * u, at = t_[i] + u;
    const double middle = std::floor(top + 0.5);
    part(count_[i], middle, top, at, -1, i);
    part(middle, count_[i + 1], top, at, 1, i);
  }
  void part(double from, double to, double top, double at, double sign, size_t i) {
    const double net = to - from, d = net < 0 ? -1.0 : 1.0;
    const int steps = int(net * d);
    if (steps == 0) return;
    double* t = out_->extend(size_t(steps), int(d));
    for (int j = 0; j < steps; ++j) {
      const double y = (from + (0.5 + double(j)) * d - top) * 2 / a_[i];
      const double x = at + sign * std::sqrt(y > 0 ? y : 0.0);
      t[j] = std::min(std::max(x, t_[i]), t_[i + 1]);
    }
  }
};

}  // namespace passo
