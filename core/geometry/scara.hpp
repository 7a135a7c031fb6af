// SCARA: an upper arm turns about the origin, and a forearm at its end. Z has a motor of its own.
#pragma once
#include "geometry/arm_angle_branch.hpp"
#include "geometry/sphere.hpp"

namespace passo {

class Scara : public Geometry {
 public:
  // The motor turns a part of length `near`, and the nozzle is `far` from the end of that part. For
  // the shoulder motor that end is the elbow. An elbow motor that keeps the forearm's absolute
  // angle turns the opposite side of the parallelogram.
  struct Arm {
    double near, far;
    bool forearm;
    double x_offset, y_offset;
    Facing facing;
    static constexpr bool kLifts = false;
    double sample_mm = 1;
    void local(const double p[3], double out[3]) const {
      out[0] = p[0] - x_offset, out[1] = p[1] - y_offset, out[2] = 0;
    }
    double value(const double p[3]) const {
      double r2 = p[0] * p[0] + p[1] * p[1], d = std::sqrt(r2);
      if (!arm_reaches(d, near, far)) return std::nan("");
      double cosine = (r2 + near * near - far * far) / (2 * near * d);
      double angle = facing.angle(p[1], p[0]) + (forearm ? 1 : -1) * acos(cosine);
      return angle * (180 / kPi);
    }
    Centre centre(double q) const {
      double s, c, k = kPi / 180;
      sincos(q * k, s, c);
      return {{near * c, near * s, 0},
              {-near * s * k, near * c * k, 0},
              {-near * c * k * k, -near * s * k * k, 0},
              far * far,
              0,
              0};
    }
    void centres(double q, double dq, int n, double* cx, double* cy, double* cz, double* r2) const {
      sincos_even(q * (kPi / 180), dq * (kPi / 180), n, cy, cx);
      for (int j = 0; j < in_fours(n); ++j) {
        double s = cy[j], c = cx[j];
        cx[j] = near * c, cy[j] = near * s, cz[j] = 0, r2[j] = far * far;
      }
    }
  };
  // An elbow motor on the upper arm. Its angle E determines the nozzle's distance from the
  // shoulder: |P|² = arm1² + arm2² + 2 arm1 arm2 cos E.
  struct Elbow {
    double arm1, arm2, x_offset, y_offset;
    static constexpr bool kLifts = false;
    double sample_mm = 1;
    void local(const double p[3], double out[3]) const {
      out[0] = p[0] - x_offset, out[1] = p[1] - y_offset, out[2] = 0;
    }
    double value(const double p[3]) const {
      double cosine = (p[0] * p[0] + p[1] * p[1] - arm1 * arm1 - arm2 * arm2) / (2 * arm1 * arm2);
      return std::fabs(cosine) <= 1 ? acos(cosine) * (180 / kPi) : std::nan("");
    }
    Centre centre(double q) const {
      double s, c, k = kPi / 180, both = 2 * arm1 * arm2;
      sincos(q * k, s, c);
      return {{0, 0, 0},     {0, 0, 0},        {0, 0, 0}, arm1 * arm1 + arm2 * arm2 + both * c,
              -both * s * k, -both * c * k * k};
    }
    void centres(double q, double dq, int n, double* cx, double* cy, double* cz, double* r2) const {
      sincos_even(q * (kPi / 180), dq * (kPi / 180), n, cy, cx);
      for (int j = 0; j < in_fours(n); ++j) {
        double c = cx[j];
        cx[j] = cy[j] = cz[j] = 0;
        r2[j] = arm1 * arm1 + arm2 * arm2 + 2 * arm1 * arm2 * c;
      }
    }
  };

  // `middle`: direction to the nozzle at the middle of each motor's range of angles, degrees.
  Scara(double arm1, double arm2, bool external_motor, double x_offset, double y_offset,
        double middle1, double middle2)
      : external_(external_motor), arm1_(arm1), arm2_(arm2), x_(x_offset), y_(y_offset),
        shoulder_{arm1, arm2, false, x_offset, y_offset, Facing(middle1)},
        forearm_{arm2, arm1, true, x_offset, y_offset, Facing(middle2)},
        elbow_{arm1, arm2, x_offset, y_offset} {}
  int actuators() const override { return 3; }
  bool linear(int i, double c[3]) const override {
    c[0] = c[1] = 0;
    c[2] = 1;
    return i == 2;
  }
  double inverse(int i, const double p[3]) const override {
    if (i == 2) return p[2];
    if (i == 0) return SphereSolver<Arm>::value(shoulder_, p);
    return external_ ? SphereSolver<Arm>::value(forearm_, p)
                     : SphereSolver<Elbow>::value(elbow_, p);
  }
  bool forward(const double* q, double p[3]) const override {
    double s1, c1, s2, c2;
    sincos(q[0] * (kPi / 180), s1, c1);
    sincos((external_ ? q[1] : q[0] + q[1]) * (kPi / 180), s2, c2);
    p[0] = arm1_ * c1 + arm2_ * c2 + x_;
    p[1] = arm1_ * s1 + arm2_ * s2 + y_;
    p[2] = q[2];
    return true;
  }
  void slopes(int i, const Path& path, double s, double& d1, double& d2) const override {
    if (i == 2) {
      d1 = (path.p1[2] - path.p0[2]) / path.length;
      d2 = 0;
    } else if (i == 0 || external_) {
      SphereSolver<Arm>::slopes(i == 0 ? shoulder_ : forearm_, path, s, d1, d2);
    } else {
      SphereSolver<Elbow>::slopes(elbow_, path, s, d1, d2);
    }
  }
  void crossings(int i, const Path& path, double per_unit, Crossings& out) const override {
    if (i == 0 || external_)
      SphereSolver<Arm>::crossings(i == 0 ? shoulder_ : forearm_, path, per_unit, out);
    else
      SphereSolver<Elbow>::crossings(elbow_, path, per_unit, out);
  }
  bool jumps(const double p0[3], const double p1[3]) const override {
    double y0 = p0[1] - y_, x0 = p0[0] - x_, y1 = p1[1] - y_, x1 = p1[0] - x_;
    return shoulder_.facing.jumps(y0, x0, y1, x1) || forearm_.facing.jumps(y0, x0, y1, x1);
  }
  double grain(const double p[3], double around) const override {
    return grain_at(p[0] - x_, p[1] - y_, around, arm1_ - arm2_);
  }

 private:
  bool external_;
  double arm1_, arm2_, x_, y_;
  Arm shoulder_, forearm_;
  Elbow elbow_;
};

}  // namespace passo
