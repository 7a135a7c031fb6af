// Additional samples between the even samples of a line, where the geometry bends sharply.
#pragma once
#include "geometry/geometry.hpp"

namespace passo {

class Sampling {
 public:
  // The samples of a line of `mm` at n points; the ends must outlive this.
  Sampling(const Geometry& geometry, const double* p0, const double* p1, double mm, int n)
      : geometry_(geometry), p0_(p0), p1_(p1), mm_(mm), n_(n),
        even_(mm <= kOfGrain * n * grain(0.5, mm)) {}

  // Visits fractions of the line between samples i - 1 and i, in order, until `visit` returns
  // false.
  template <typename Visit>
  bool before(int i, const Visit& visit) const {
    return even_ || between(double(i - 1) / n_, double(i) / n_, visit);
  }

 private:
  static constexpr double kFinest = 1e-3;  // mm
  static constexpr double kOfGrain = 0.1;  // so coarse that no slope between is 1 % steeper
  const Geometry& geometry_;
  const double *p0_, *p1_;
  double mm_;
  int n_;
  bool even_;

  // The least along the part of `mm` about this fraction.
  double grain(double at, double mm) const {
    double p[3];
    for (int j = 0; j < 3; ++j) p[j] = p0_[j] + (p1_[j] - p0_[j]) * at;
    return geometry_.grain(p, 0.5 * mm);
  }
  template <typename Visit>
  bool between(double from, double to, const Visit& visit) const {
    double mm = (to - from) * mm_, middle = 0.5 * (from + to);
    if (mm < kFinest || mm <= kOfGrain * grain(middle, mm)) return true;
    return between(from, middle, visit) && visit(middle) && between(middle, to, visit);
  }
};

}  // namespace passo
