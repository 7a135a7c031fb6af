// Additional samples between the even samples of a line, where the geometry changes its slopes
// quickly.
#pragma once
#include "geometry/geometry.hpp"

namespace passo {

class Sampling {
 public:
  // Divides a line of `mm` into n even parts. Both ends must outlive this object.
  Sampling(const Geometry& geometry, const double* p0, const double* p1, double mm, int n)
      : geometry_(geometry), p0_(p0), p1_(p1), mm_(mm), n_(n),
        even_(mm <= kOfGrain * n * grain(0.5, mm)) {}

  // Visits the additional samples between even samples i - 1 and i, as fractions of the line, in
  // order. Stops if `visit` returns false.
  template <typename Visit>
  bool before(int i, const Visit& visit) const {
    return even_ || between(double(i - 1) / n_, double(i) / n_, visit);
  }

 private:
  static constexpr double kFinest = 1e-3;  // mm
  static constexpr double kOfGrain =
      0.1;  // of the grain; within it no slope changes by more than 1 %
  const Geometry& geometry_;
  const double *p0_, *p1_;
  double mm_;
  int n_;
  bool even_;

  // The geometry's grain around a fraction of the line, within `mm`.
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
