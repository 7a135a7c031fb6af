// Cable winch: cables from fixed anchors hold the nozzle.
#pragma once
#include <algorithm>
#include <stdexcept>

#include "base/types.hpp"
#include "geometry/distance.hpp"

namespace passo {

class Winch : public Geometry {
 public:
  // `anchors`: X, Y and Z of each. `side` is 1 if the nozzle is below the plane of the first three
  // anchors, else -1; only a machine with three cables needs it.
  Winch(const std::vector<double>& anchors, double side) : side_(side) {
    for (size_t i = 0; i + 2 < anchors.size(); i += 3)
      cables_.push_back({anchors[i], anchors[i + 1], anchors[i + 2], kNear, false});
    if (cables_.size() < 3 || cables_.size() > size_t(kMostActuators))
      throw std::invalid_argument("a winch has 3 to 8 cables");
  }
  int actuators() const override { return int(cables_.size()); }
  bool linear(int, double*) const override { return false; }
  double inverse(int i, const double p[3]) const override {
    return SphereSolver<Distance>::value(cable(i), p);
  }
  // The lengths of three cables leave two places, on either side of the plane of their anchors.
  // The further cables decide.
  bool forward(const double* q, double p[3]) const override {
    double below[3], above[3];
    if (cables_.size() == 3) return from_three(q, p, side_);
    if (!from_three(q, below, 1) || !from_three(q, above, -1)) return false;
    std::copy_n(error(q, below) <= error(q, above) ? below : above, 3, p);
    return true;
  }
  void slopes(int i, const Path& path, double s, double& d1, double& d2) const override {
    SphereSolver<Distance>::slopes(cable(i), path, s, d1, d2);
  }
  void crossings(int i, const Path& path, double per_unit, Crossings& out) const override {
    SphereSolver<Distance>::crossings(cable(i), path, per_unit, out);
  }
  double grain(const double p[3], double around) const override {
    double least = kInfinity;
    for (const Distance& cable : cables_) least = std::min(least, cable.grain(p, around));
    return least;
  }

 private:
  static constexpr double kNear = 1;  // mm
  std::vector<Distance> cables_;
  double side_;

  const Distance& cable(int i) const { return cables_[size_t(i)]; }
  bool from_three(const double* q, double p[3], double side) const {
    double c[3][3];
    for (size_t i = 0; i < 3; ++i)
      c[i][0] = cables_[i].x, c[i][1] = cables_[i].y, c[i][2] = cables_[i].z;
    return trilaterate(c, q, p, side);
  }
  // How far the cables after the third one differ from these lengths at p, mm.
  double error(const double* q, const double p[3]) const {
    double sum = 0;
    for (int i = 3; i < actuators(); ++i) {
      double at[3];
      cable(i).local(p, at);
      sum += std::fabs(std::sqrt(at[0] * at[0] + at[1] * at[1] + at[2] * at[2]) - q[i]);
    }
    return sum;
  }
};

}  // namespace passo
