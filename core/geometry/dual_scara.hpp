// Dual-arm SCARA (five-bar): two arms from two shoulders meet at the nozzle. Z has a motor of its
// own.
#pragma once
#include <array>

#include "geometry/arm_angle_branch.hpp"
#include "geometry/sphere.hpp"

namespace passo {

class DualScara : public Geometry {
 public:
  // Angles are in degrees from +Y towards +X. The elbow is on the outside of the line from shoulder
  // to nozzle.
  struct Arm {
    double shoulder, proximal, distal, x_offset, y_offset;
    int outside;  // -1: left arm, elbow to the left; +1: right arm
    Facing facing;
    static constexpr bool kLifts = false;
    double sample_mm = 1;
    void local(const double p[3], double out[3]) const {
      out[0] = p[0] - x_offset, out[1] = p[1] - y_offset, out[2] = 0;
    }
    double value(const double p[3]) const {
      double dx = p[0] - shoulder, dy = p[1], r2 = dx * dx + dy * dy, d = std::sqrt(r2);
      if (!arm_reaches(d, proximal, distal)) return std::nan("");
      double cosine = (r2 + proximal * proximal - distal * distal) / (2 * proximal * d);
      return (facing.angle(dx, dy) + outside * acos(cosine)) * (180 / kPi);
    }
    Centre centre(double q) const {
      double s, c, k = kPi / 180;
      sincos(q * k, s, c);
      return {{shoulder + proximal * s, proximal * c, 0},
              {proximal * c * k, -proximal * s * k, 0},
              {-proximal * s * k * k, -proximal * c * k * k, 0},
              distal * distal,
              0,
              0};
    }
    void centres(double q, double dq, int n, double* cx, double* cy, double* cz, double* r2) const {
      sincos_even(q * (kPi / 180), dq * (kPi / 180), n, cx, cy);
      for (int j = 0; j < in_fours(n); ++j) {
        double s = cx[j], c = cy[j];
        cx[j] = shoulder + proximal * s, cy[j] = proximal * c, cz[j] = 0, r2[j] = distal * distal;
      }
    }
  };

  // `middle`: direction from each shoulder to the nozzle at the middle of its range of angles,
  // degrees.
  DualScara(double shoulder1, double shoulder2, double proximal1, double proximal2, double distal1,
            double distal2, double x_offset, double y_offset, double middle1, double middle2)
      : arms_{Arm{shoulder1, proximal1, distal1, x_offset, y_offset, -1, Facing(middle1)},
              Arm{shoulder2, proximal2, distal2, x_offset, y_offset, 1, Facing(middle2)}} {}
  int actuators() const override { return 3; }
  bool linear(int i, double c[3]) const override {
    c[0] = c[1] = 0;
    c[2] = 1;
    return i == 2;
  }
  double inverse(int i, const double p[3]) const override {
    if (i == 2) return p[2];
    double q[2], local[3];
    arms_[0].local(p, local);
    for (size_t k = 0; k < 2; ++k) q[k] = arms_[k].value(local);
    if (!(std::fabs(q[0]) < 1e9 && std::fabs(q[1]) < 1e9)) return std::nan("");
    Centre a = arms_[0].centre(q[0]),
           b = arms_[1].centre(q[1]);  // the distal joint must stay convex
    double bend = (b.c[0] - a.c[0]) * (local[1] - a.c[1]) - (b.c[1] - a.c[1]) * (local[0] - a.c[0]);
    return bend > 0 ? q[i] : std::nan("");
  }
  bool forward(const double* q, double p[3]) const override {
    Centre a = arms_[0].centre(q[0]), b = arms_[1].centre(q[1]);
    double dx = b.c[0] - a.c[0], dy = b.c[1] - a.c[1], d2 = dx * dx + dy * dy;
    double along = (a.r2 - b.r2 + d2) / (2 * d2), h2 = a.r2 / d2 - along * along;
    if (!(h2 >= 0)) return false;
    double h = std::sqrt(h2);
    p[0] = a.c[0] + along * dx - h * dy + arms_[0].x_offset;
    p[1] = a.c[1] + along * dy + h * dx + arms_[0].y_offset;
    p[2] = q[2];
    return true;
  }
  void slopes(int i, const Path& path, double s, double& d1, double& d2) const override {
    if (i == 2) {
      d1 = (path.p1[2] - path.p0[2]) / path.length;
      d2 = 0;
    } else {
      SphereSolver<Arm>::slopes(arms_[size_t(i)], path, s, d1, d2);
    }
  }
  void crossings(int i, const Path& path, double per_unit, Crossings& out) const override {
    SphereSolver<Arm>::crossings(arms_[size_t(i)], path, per_unit, out);
  }
  bool jumps(const double p0[3], const double p1[3]) const override {
    double a[3], b[3];
    arms_[0].local(p0, a);
    arms_[0].local(p1, b);
    for (const Arm& arm : arms_)
      if (arm.facing.jumps(a[0] - arm.shoulder, a[1], b[0] - arm.shoulder, b[1])) return true;
    return false;
  }
  double grain(const double p[3], double around) const override {
    double local[3];
    arms_[0].local(p, local);
    auto of = [&](const Arm& arm) {
      return grain_at(local[0] - arm.shoulder, local[1], around, arm.proximal - arm.distal);
    };
    return std::fmin(of(arms_[0]), of(arms_[1]));
  }

 private:
  std::array<Arm, 2> arms_;
};

}  // namespace passo
