// Step times in intervals in which a motor's position is a cubic of time.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>

#include "base/simd.hpp"
#include "steps/steps.hpp"

namespace passo {

// Finds the roots of s x + b x^2 + c x^3 = y on 0..1, a block at a time. x = 0 is the slower end of
// an interval without a turn. The step is at base + span * x.
class CubicSolver {
 public:
  void into(Steps& out, TimedTolerances& tolerances) { out_ = &out, tolerances_ = &tolerances; }

  // Adds the interval that starts at t0 and lasts d ticks. The position is c0 + c1 x + c2 x^2 + c3
  // x^3 on 0..1, relative to the last step count, and `end` at x = 1. It contains n net steps.
  void cubic(double t0, double d, double c0, double c1, double c2, double end, double n) {
    const double c3 = end - c0 - c1 - c2, dir = n < 0 ? -1 : 1;
    const double s0 = c1 * dir, s1 = s0 + 2 * c2 * dir + 3 * c3 * dir;
    if (n != 0 && s0 >= 0 && s0 + c2 * dir >= 0 && s1 >= 0) [[likely]] {
      rising(t0, d, c0, end, s0, s1, c2 * dir, c3 * dir, n, dir);
      return;
    }
    // Splits the interval where the cubic turns, which is at most twice.
    double x[4] = {0, 1, 1, 1};
    int parts = 1;
    const double A = 3 * c3, B = c2, D = B * B - A * c1;  // A x^2 + 2 B x + c1 = 0
    if (D > 0) {
      const double r = -(B + (B < 0 ? -std::sqrt(D) : std::sqrt(D)));
      double first = r / A, second = c1 / r;
      if (!(first <= second)) std::swap(first, second);
      if (first > 0 && first < 1) x[parts++] = first;
      if (second > 0 && second < 1) x[parts++] = second;
    }
    x[parts] = 1;
    double from = c0, done = 0;
    for (int i = 0; i < parts; ++i) {
      const double l = x[i + 1] - x[i], x0 = x[i], x1 = x[i + 1];
      const double to = i + 1 == parts ? end : c0 + x1 * (c1 + x1 * (c2 + x1 * c3));
      const double part = std::floor(to + 0.5) - done, sign = part < 0 ? -1 : 1;
      if (part != 0) {
        const double a1 = (c1 + x0 * (2 * c2 + 3 * c3 * x0)) * l, a2 = (c2 + 3 * c3 * x0) * l * l,
                     a3 = c3 * l * l * l;
        rising(t0 + x0 * d, d * l, from - done, to - done, std::max(a1 * sign, 0.0),
               std::max((a1 + 2 * a2 + 3 * a3) * sign, 0.0), a2 * sign, a3 * sign, part, sign);
      }
      done += part;
      from = to;
    }
  }
  void flush() {
    if (used_ == 0) return;
    for (size_t i = used_; i < size_t(in_fours(int(used_))); ++i)
      base_[i] = span_[i] = b_[i] = c_[i] = y_[i] = 0, s_[i] = 1;
    halley(*this, int(used_));
    for (size_t i = 0; i < used_; ++i) {
      const double x = off_[i] <= 0 ? x_[i] : bracketed(i);
      const double t = base_[i] + span_[i] * x;
      tolerances_->apply(t, *out_);
      *out_->extend(1, dir_[i]) = t;
    }
    used_ = 0;
  }

 private:
  static constexpr size_t kBlock = 512;
  static constexpr double kLastStep = 2.5e-4;  // of x; the error of the next step would be its cube
  double base_[kBlock], span_[kBlock], s_[kBlock], b_[kBlock], c_[kBlock], y_[kBlock], x_[kBlock],
      off_[kBlock];
  int dir_[kBlock];
  size_t used_ = 0;
  Steps* out_ = nullptr;
  TimedTolerances* tolerances_ = nullptr;

  // Two steps of Halley's method, starting with the root of the quadratic that has the same values
  // and slopes at the ends. off > 0: the second step was too large to be the last one.
  PASSO_SIMD static void halley(CubicSolver& o, int n) {
    for (int i = 0; i < in_fours(n); ++i) {
      const double s = o.s_[i], b = o.b_[i], c = o.c_[i], y = o.y_[i];
      const double h = 0.5 * s, r = h * h + (b + c) * y;
      double x = y / (h + std::sqrt(r > 0 ? r : 0.0)), step = 0;
      for (int k = 0; k < 2; ++k) {
        const double c3 = 3 * c * x, f = ((c * x + b) * x + s) * x - y;
        const double f1 = (c3 + 2 * b) * x + s, f2 = c3 + b;  // half the second derivative
        step = f * f1 / (f1 * f1 - f * f2);
        x = x - step;
      }
      o.x_[i] = x;
      o.off_[i] = x <= 1 ? std::fabs(step) - kLastStep * x : 1.0;
    }
  }
  double bracketed(size_t i) const {
    double low = 0, high = 1, x = 0.5;
    for (int k = 0; k < 100; ++k) {
      const double f = ((c_[i] * x + b_[i]) * x + s_[i]) * x - y_[i];
      const double slope = (3 * c_[i] * x + 2 * b_[i]) * x + s_[i];
      (f < 0 ? low : high) = x;
      double to = x - f / slope;
      if (std::fabs(to - x) <= 1e-13) return std::min(std::max(to, low), high);
      if (!(to > low && to < high) || k > 40) to = 0.5 * (low + high);
      x = to;
    }
    return x;
  }
  // Adds the steps of an interval without a turn, in direction `dir`. s0 and s1 are the speeds at
  // its ends.
  void rising(double t0, double d, double from, double to, double s0, double s1, double c2,
              double c3, double n, double dir) {
    const bool up = s0 <= s1;
    const double s = std::max(up ? s0 : s1, 1e-150), b = up ? c2 : -(c2 + 3 * c3);
    double y = up ? (0.5 * dir - from) * dir : (to - 0.5 * dir) * dir;
    for (int left = int(n * dir); left > 0; --left, y += up ? 1 : -1) {
      if (used_ == kBlock) flush();
      const size_t i = used_++;
      base_[i] = up ? t0 : t0 + d;
      span_[i] = up ? d : -d;
      s_[i] = s, b_[i] = b, c_[i] = c3;
      y_[i] = std::max(y, 0.0);
      dir_[i] = int(dir);
    }
  }
};

}  // namespace passo
