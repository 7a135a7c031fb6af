// Deltesian: two carriages on vertical towers hold the effector by rods in the plane XZ. Y has a
// motor of its own.
#pragma once
#include <array>

#include "base/types.hpp"
#include "geometry/sphere.hpp"

namespace passo {

class Deltesian : public Geometry {
 public:
  // A rod between the effector and a carriage at `x`. Beyond `far` from the tower it is too flat.
  struct Tower {
    double x, rod2, far;
    static constexpr bool kLifts = true;
    double sample_mm = 1e9;  // along a line the carriage turns at most once: its height is concave
    void local(const double p[3], double out[3]) const { out[0] = p[0], out[1] = 0, out[2] = p[2]; }
    double value(const double p[3]) const {
      double dx = x - p[0];
      return std::fabs(dx) <= far ? p[2] + std::sqrt(rod2 - dx * dx) : std::nan("");
    }
    Centre centre(double q) const { return {{x, 0, q}, {0, 0, 1}, {0, 0, 0}, rod2, 0, 0}; }
  };

  // `towers`: X of the left and of the right tower; `min_angle` of a rod to the horizontal,
  // degrees.
  Deltesian(const std::vector<double>& towers, const std::vector<double>& rods, double min_angle) {
    double s, c;
    sincos(min_angle * (kPi / 180), s, c);
    for (size_t i = 0; i < 2; ++i)
      towers_[i] = Tower{towers.at(i), rods.at(i) * rods.at(i), rods.at(i) * c};
  }
  int actuators() const override { return 3; }
  bool linear(int i, double c[3]) const override {
    c[0] = c[2] = 0;
    c[1] = 1;
    return i == kY;
  }
  double inverse(int i, const double p[3]) const override {
    return i == kY ? p[1] : SphereSolver<Tower>::value(tower(i), p);
  }
  // The lower crossing of two circles about the carriages.
  bool forward(const double* q, double p[3]) const override {
    const Tower &left = towers_[0], &right = towers_[1];
    double dx = right.x - left.x, dz = q[kRight] - q[kLeft], square = dx * dx + dz * dz;
    double along = (left.rod2 - right.rod2 + square) / (2 * square);
    double below2 = left.rod2 / square - along * along;
    if (!(below2 >= 0)) return false;
    double below = std::sqrt(below2);
    p[0] = left.x + along * dx + below * dz;
    p[1] = q[kY];
    p[2] = q[kLeft] + along * dz - below * dx;
    return true;
  }
  void slopes(int i, const Path& path, double s, double& d1, double& d2) const override {
    if (i == kY) {
      d1 = (path.p1[1] - path.p0[1]) / path.length;
      d2 = 0;
    } else {
      SphereSolver<Tower>::slopes(tower(i), path, s, d1, d2);
    }
  }
  void crossings(int i, const Path& path, double per_unit, Crossings& out) const override {
    SphereSolver<Tower>::crossings(tower(i), path, per_unit, out);
  }

 private:
  static constexpr int kLeft = 0, kY = 1, kRight = 2;
  std::array<Tower, 2> towers_;

  const Tower& tower(int i) const { return towers_[i == kRight]; }
};

}  // namespace passo
