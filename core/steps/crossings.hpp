// Finds when a smooth function of time crosses given values. It first divides the time into
// intervals in which the function only rises or only falls, and then finds the roots in each by a
// bracket.
//
// Curve: double value(double t) and double slope(double t), its derivative.
#pragma once
#include <algorithm>
#include <cmath>
#include <vector>

namespace passo {

// Appends the times in (a, b) at which the curve turns, in order, and then b. An interval is halved
// until the cubic through the values and slopes at its ends matches the curve within `exact` at one
// third and at two thirds. For polynomials up to degree 5 that proves the match; for other curves
// it relies on their smoothness. Then the turns are searched in the slope of the curve itself.
template <class Curve>
class Turns {
 public:
  Turns(const Curve& curve, double exact, std::vector<double>& turns)
      : curve_(curve), exact_(exact), turns_(turns) {}

  void find(double a, double b) { halve(end_at(a), end_at(b), 0); }

 private:
  static constexpr int kDeepest = 40;
  struct End {
    double t, value, slope;
  };
  const Curve& curve_;
  double exact_;
  std::vector<double>& turns_;

  End end_at(double t) const { return {t, curve_.value(t), curve_.slope(t)}; }

  void halve(const End& a, const End& b, int depth) {
    double h = b.t - a.t, va = a.slope * h, vb = b.slope * h;
    double third = (20 * a.value + 7 * b.value + 4 * va - 2 * vb) / 27;
    double two_thirds = (7 * a.value + 20 * b.value + 2 * va - 4 * vb) / 27;
    bool agrees = !(std::fabs(curve_.value(a.t + h / 3) - third) > exact_) &&
                  !(std::fabs(curve_.value(a.t + 2 * h / 3) - two_thirds) > exact_);
    if (!agrees && depth < kDeepest) {
      End middle = end_at(a.t + 0.5 * h);
      halve(a, middle, depth + 1);
      halve(middle, b, depth + 1);
      return;
    }
    // The cubic turns at most once on each side of its steepest point, also if its slope is 0 at an
    // end.
    double rise = b.value - a.value, square = 3 * rise - 2 * va - vb, cube = va + vb - 2 * rise;
    double steepest = -square / (3 * cube);
    if (steepest > 0 && steepest < 1) {
      End middle = end_at(a.t + steepest * h);
      turn_between(a, middle);
      turn_between(middle, b);
    } else {
      turn_between(a, b);
    }
    turns_.push_back(b.t);
  }

  void turn_between(const End& a, const End& b) {
    if (!(a.slope * b.slope < 0)) return;
    double low = a.t, high = b.t;
    for (int i = 0; i < 100; ++i) {
      double middle = 0.5 * (low + high);
      if (middle <= low || middle >= high) break;
      (curve_.slope(middle) * a.slope > 0 ? low : high) = middle;
    }
    turns_.push_back(high);
  }
};

// The time at which a curve that only rises (dir 1) or only falls (dir -1) crosses `value` between
// a and b. If rounding keeps the curve from reaching the value, returns the nearer end. Uses
// Newton's method within a bracket.
template <class Curve>
double crossing(const Curve& curve, double value, double dir, double a, double b) {
  constexpr double kNear = 1e-13;  // s, a millionth of a tick
  double at_a = dir * (curve.value(a) - value);
  if (!(at_a < 0)) return a;
  if (!(dir * (curve.value(b) - value) > 0)) return b;
  double low = a, high = b, t = a - at_a / (dir * curve.slope(a));
  if (!(t > low && t < high)) t = 0.5 * (low + high);
  for (int i = 0; i < 100; ++i) {
    double beyond = dir * (curve.value(t) - value);
    (beyond < 0 ? low : high) = t;
    double next = t - beyond / (dir * curve.slope(t));
    if (std::fabs(next - t) <= kNear) return std::min(std::max(next, low), high);
    if (!(next > low && next < high) || i > 30) next = 0.5 * (low + high);
    if (high - low <= kNear) return next;
    t = next;
  }
  return t;
}

}  // namespace passo
