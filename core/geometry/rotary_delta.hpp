// Rotational delta: three arms turn at the base, and rods connect their elbows to the effector.
#pragma once
#include <array>

#include "geometry/sphere.hpp"

namespace passo {

class RotaryDelta : public Geometry {
 public:
  // In its own frame the arm swings in the plane x = 0 about (0, shoulder). Its elbow is at (0,
  // shoulder - arm cos θ, -arm sin θ). The joint of the effector is `effector` nearer to the base's
  // edge.
  struct Arm {
    double sine, cosine;  // of the arm's direction around Z
    double shoulder, effector, arm, rod2, z_offset;
    static constexpr bool kLifts = false;
    double sample_mm = 1;
    void local(const double p[3], double out[3]) const {
      out[0] = p[0] * cosine + p[1] * sine;
      out[1] = p[1] * cosine - p[0] * sine - effector;
      out[2] = p[2] - z_offset;
    }
    // The angle in degrees. If w goes from the shoulder to the joint, the elbow's direction e
    // satisfies w·e = (w² + arm² - rod² + x²) / (2 arm). Of its two solutions the outer one
    // applies.
    double value(const double p[3]) const {
      double wy = p[1] - shoulder, wz = p[2], w2 = wy * wy + wz * wz;
      double cosine_of = (w2 + arm * arm - rod2 + p[0] * p[0]) / (2 * arm * std::sqrt(w2));
      if (!(std::fabs(cosine_of) <= 1)) return std::nan("");
      double angle = atan2(wz, wy) - acos(cosine_of) + kPi;  // -kPi or more
      if (angle > kPi) angle -= 2 * kPi;
      return angle * (180 / kPi);
    }
    Centre centre(double q) const {
      double s, c, k = kPi / 180;
      sincos(q * k, s, c);
      return {{0, shoulder - arm * c, -arm * s},
              {0, arm * s * k, -arm * c * k},
              {0, arm * c * k * k, arm * s * k * k},
              rod2,
              0,
              0};
    }
    void centres(double q, double dq, int n, double* cx, double* cy, double* cz, double* r2) const {
      sincos_even(q * (kPi / 180), dq * (kPi / 180), n, cz, cy);
      for (int j = 0; j < in_fours(n); ++j) {
        double s = cz[j], c = cy[j];
        cx[j] = 0, cy[j] = shoulder - arm * c, cz[j] = -arm * s, r2[j] = rod2;
      }
    }
  };

  RotaryDelta(double effector_length, double base_length, double rod, double arm, double z_offset) {
    const double kHalfTan30 = 0.28867513459481287;
    const double sines[] = {0, 0.86602540378443864676, -0.86602540378443864676},
                 cosines[] = {1, -0.5, -0.5};
    for (size_t i = 0; i < 3; ++i)
      arms_[i] =
          Arm{sines[i],  cosines[i], -base_length * kHalfTan30, effector_length * kHalfTan30, arm,
              rod * rod, z_offset};
  }
  int actuators() const override { return 3; }
  bool linear(int, double*) const override { return false; }
  double inverse(int i, const double p[3]) const override {
    return SphereSolver<Arm>::value(arms_[size_t(i)], p);
  }
  bool forward(const double* q, double p[3]) const override {
    double c[3][3], r[3];
    for (size_t i = 0; i < 3; ++i) {
      const Arm& a = arms_[i];
      Centre e = a.centre(q[i]);
      double y =
          e.c[1] + a.effector;  // elbow, shifted so that the rod ends in the middle of the effector
      c[i][0] = -y * a.sine, c[i][1] = y * a.cosine, c[i][2] = e.c[2] + a.z_offset;
      r[i] = std::sqrt(a.rod2);
    }
    return trilaterate(c, r, p);
  }
  void slopes(int i, const Path& path, double s, double& d1, double& d2) const override {
    SphereSolver<Arm>::slopes(arms_[size_t(i)], path, s, d1, d2);
  }
  void crossings(int i, const Path& path, double per_unit, Crossings& out) const override {
    SphereSolver<Arm>::crossings(arms_[size_t(i)], path, per_unit, out);
  }

 private:
  std::array<Arm, 3> arms_;
};

}  // namespace passo
