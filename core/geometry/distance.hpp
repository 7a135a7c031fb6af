// An actuator whose position is the distance of the nozzle from a fixed point, or from a vertical
// line: a cable, or the arm of a polar machine.
#pragma once
#include "geometry/sphere.hpp"

namespace passo {

// A kernel of SphereSolver. Within `near` mm the actuator would have to turn at once.
struct Distance {
  double x, y, z, near;
  bool flat;  // from the vertical line: Z does not count
  static constexpr bool kLifts = false;
  double sample_mm = 1e9;  // along a line the actuator turns at most once: its position is convex
  void local(const double p[3], double out[3]) const {
    out[0] = p[0] - x, out[1] = p[1] - y, out[2] = flat ? 0 : p[2] - z;
  }
  double value(const double p[3]) const {
    const double d = std::sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
    return d >= near ? d : std::nan("");
  }
  Centre centre(double q) const { return {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, q * q, 2 * q, 2}; }
  void centres(double q, double dq, int n, double* cx, double* cy, double* cz, double* r2) const {
    for (int j = 0; j < in_fours(n); ++j) {
      const double r = q + dq * j;
      cx[j] = cy[j] = cz[j] = 0, r2[j] = r * r;
    }
  }
  // Geometry::grain at p: the slopes change completely within the distance.
  double grain(const double p[3], double around) const {
    double at[3];
    local(p, at);
    return std::max(0.0, std::sqrt(at[0] * at[0] + at[1] * at[1] + at[2] * at[2]) - around);
  }
};

}  // namespace passo
