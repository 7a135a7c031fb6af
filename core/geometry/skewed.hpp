// A geometry whose axes are not at right angles to each other.
#pragma once
#include <memory>
#include <utility>

#include "geometry/geometry.hpp"

namespace passo {

// The positions of the axes are linear in the position of the nozzle. The factors of the planes XY,
// XZ and YZ are those of Klipper and Marlin (M852):
//   x' = x - xy y - (xz - xy yz) z,  y' = y - yz z,  z' = z
class Skewed : public Geometry {
 public:
  Skewed(std::unique_ptr<const Geometry> axes, double xy, double xz, double yz)
      : axes_(std::move(axes)), xy_(xy), xz_(xz - xy * yz), yz_(yz) {}
  int actuators() const override { return axes_->actuators(); }
  bool linear(int i, double c[3]) const override {
    if (!axes_->linear(i, c)) return false;
    c[2] -= c[0] * xz_ + c[1] * yz_;
    c[1] -= c[0] * xy_;
    return true;
  }
  double turn(int i) const override { return axes_->turn(i); }
  double inverse(int i, const double p[3]) const override {
    double at[3];
    shear(p, at);
    return axes_->inverse(i, at);
  }
  bool forward(const double* q, double p[3]) const override {
    if (!axes_->forward(q, p)) return false;
    p[1] += yz_ * p[2];
    p[0] += xy_ * p[1] + xz_ * p[2];
    return true;
  }
  void slopes(int i, const Path& path, double s, double& d1, double& d2) const override {
    axes_->slopes(i, sheared(path), s, d1, d2);
  }
  void crossings(int i, const Path& path, double steps_per_unit, Crossings& out) const override {
    axes_->crossings(i, sheared(path), steps_per_unit, out);
  }
  bool jumps(const double from[3], const double to[3]) const override {
    const Path path = sheared({{from[0], from[1], from[2]}, {to[0], to[1], to[2]}, 0});
    return axes_->jumps(path.p0, path.p1);
  }
  double grain(const double p[3], double around) const override {
    double at[3];
    shear(p, at);
    return axes_->grain(at, around);
  }

 private:
  std::unique_ptr<const Geometry> axes_;
  double xy_, xz_, yz_;

  void shear(const double p[3], double at[3]) const {
    at[0] = p[0] - xy_ * p[1] - xz_ * p[2];
    at[1] = p[1] - yz_ * p[2];
    at[2] = p[2];
  }
  Path sheared(const Path& path) const {
    Path out;
    shear(path.p0, out.p0);
    shear(path.p1, out.p1);
    out.length = path.length;
    return out;
  }
};

}  // namespace passo
