// Linear delta: carriages on three towers, rods of fixed length to the effector.
#pragma once
#include <array>

#include "geometry/sphere.hpp"

namespace passo {

class Delta : public Geometry {
 public:
  struct Tower {
    double x, y, rod2;
    static constexpr bool kLifts = true;
    double sample_mm = 1e9;  // a carriage's height is concave along a line: at most one turn
    void local(const double p[3], double out[3]) const {
      out[0] = p[0], out[1] = p[1], out[2] = p[2];
    }
    double value(const double p[3]) const {
      double dx = x - p[0], dy = y - p[1];
      return p[2] + std::sqrt(rod2 - dx * dx - dy * dy);
    }
    Centre centre(double q) const { return {{x, y, q}, {0, 0, 1}, {0, 0, 0}, rod2, 0, 0}; }
  };

  // Towers at `radius` from the middle and at `angles` (degrees, counter-clockwise from +X).
  Delta(double radius, const std::vector<double>& rods, const std::vector<double>& angles,
        double limit_radius)
      : limit2_(limit_radius * limit_radius) {
    for (size_t i = 0; i < 3; ++i) {
      double s, c;
      sincos(angles.at(i) * (kPi / 180), s, c);
      towers_[i] = Tower{radius * c, radius * s, rods.at(i) * rods.at(i)};
    }
  }
  int actuators() const override { return 3; }
  bool linear(int, double*) const override { return false; }
  double inverse(int i, const double p[3]) const override {
    if (p[0] * p[0] + p[1] * p[1] > limit2_ * (1 + 1e-12)) return std::nan("");
    return towers_[size_t(i)].value(p);
  }
  bool forward(const double* q, double p[3]) const override {
    double c[3][3], r[3];
    for (size_t i = 0; i < 3; ++i) {
      c[i][0] = towers_[i].x, c[i][1] = towers_[i].y, c[i][2] = q[i];
      r[i] = std::sqrt(towers_[i].rod2);
    }
    return trilaterate(c, r, p);
  }
  void slopes(int i, const Path& path, double s, double& d1, double& d2) const override {
    SphereSolver<Tower>::slopes(towers_[size_t(i)], path, s, d1, d2);
  }
  void crossings(int i, const Path& path, double per_unit, Crossings& out) const override {
    SphereSolver<Tower>::crossings(towers_[size_t(i)], path, per_unit, out);
  }

 private:
  std::array<Tower, 3> towers_;
  double limit2_;
};

}  // namespace passo
