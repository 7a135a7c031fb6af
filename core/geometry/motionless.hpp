// A machine without X, Y and Z: only extruders and further axes move.
#pragma once
#include <cmath>

#include "geometry/geometry.hpp"

namespace passo {

class Motionless : public Geometry {
 public:
  int actuators() const override { return 0; }
  bool linear(int, double*) const override { return true; }
  double inverse(int, const double*) const override { return std::nan(""); }
  bool forward(const double*, double p[3]) const override {
    p[0] = p[1] = p[2] = 0;
    return true;
  }
  void slopes(int, const Path&, double, double& d1, double& d2) const override { d1 = d2 = 0; }
  void crossings(int, const Path&, double, Crossings& out) const override { out.clear(); }
};

}  // namespace passo
