// Cartesian and Core machines: every actuator is a fixed sum of X, Y and Z.
#pragma once
#include "geometry/geometry.hpp"

namespace passo {

class LinearGeometry : public Geometry {
 public:
  // Row i of `matrix` calculates actuator i; row i of `inverse` calculates axis i from the
  // actuators.
  LinearGeometry(const double (&matrix)[3][3], const double (&inverse)[3][3]) {
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) matrix_[i][j] = matrix[i][j], inverse_[i][j] = inverse[i][j];
  }
  int actuators() const override { return 3; }
  bool linear(int i, double c[3]) const override {
    for (int j = 0; j < 3; ++j) c[j] = matrix_[i][j];
    return true;
  }
  double inverse(int i, const double p[3]) const override {
    return matrix_[i][0] * p[0] + matrix_[i][1] * p[1] + matrix_[i][2] * p[2];
  }
  bool forward(const double* q, double p[3]) const override {
    for (int i = 0; i < 3; ++i)
      p[i] = inverse_[i][0] * q[0] + inverse_[i][1] * q[1] + inverse_[i][2] * q[2];
    return true;
  }
  void slopes(int i, const Path& path, double, double& d1, double& d2) const override {
    d1 = (inverse(i, path.p1) - inverse(i, path.p0)) / path.length;
    d2 = 0;
  }
  void crossings(int, const Path&, double, Crossings& out) const override { out.clear(); }

 private:
  double matrix_[3][3], inverse_[3][3];
};

}  // namespace passo
