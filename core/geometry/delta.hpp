// Linear delta: carriages on three towers hold the effector by rods of fixed length.
#pragma once
#include <array>

#include "base/types.hpp"
#include "geometry/sphere.hpp"
#include "geometry/track.hpp"

namespace passo {

class Delta : public Geometry {
 public:
  struct Tower {
    double x, y, rod2;
    static constexpr bool kLifts = true;
    double sample_mm = 1e9;  // along a line the carriage turns at most once: its height is concave
    void local(const double p[3], double out[3]) const {
      out[0] = p[0], out[1] = p[1], out[2] = p[2];
    }
    double value(const double p[3]) const {
      double dx = x - p[0], dy = y - p[1];
      return p[2] + std::sqrt(rod2 - dx * dx - dy * dy);
    }
    Centre centre(double q) const { return {{x, y, q}, {0, 0, 1}, {0, 0, 0}, rod2, 0, 0}; }
  };

  // The towers are at `radius` from the middle, at `angles` in degrees, counter-clockwise from +X.
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
  void follow(int i, const Track& k, Followed& out) const override {
    const Tower& tower = towers_[size_t(i)];
    const int n = int(k.n);
    out.reserve(k.n);
    double* inverse = out.error.data();  // 1/c of the columns, later replaced by the errors
    const double *t = k.t.data(), *x = k.p[0].data(), *y = k.p[1].data(), *z = k.p[2].data();
    columns(n, tower, x, y, z, out.q.data(), inverse);
    const double *x0 = k.v0[0].data(), *y0 = k.v0[1].data(), *z0 = k.v0[2].data();
    const double *x1 = k.v1[0].data(), *y1 = k.v1[1].data(), *z1 = k.v1[2].data();
    speeds(n, tower, x, y, x0, y0, z0, inverse, out.v0.data());
    speeds(n, tower, x + 1, y + 1, x1, y1, z1, inverse + 1, out.v1.data());
    middles(n, tower, t, x, y, z, x0, y0, z0, x1, y1, z1, out.middle.data());
    if (k.cubic)
      errors<true>(n, tower.rod2, t, x, y, x0, y0, x1, y1, inverse);
    else
      errors<false>(n, tower.rod2, t, x, y, x0, y0, x1, y1, inverse);
  }

 private:
  std::array<Tower, 3> towers_;
  double limit2_;

  // Height c of a carriage above the nozzle: c^2 = rod^2 - u^2, where u is the distance from the
  // tower in XY.
  PASSO_SIMD static void columns(int n, const Tower& tower, const double* __restrict x,
                                 const double* __restrict y, const double* __restrict z,
                                 double* __restrict q, double* __restrict inverse) {
    const double ax = tower.x, ay = tower.y, rod2 = tower.rod2;
    for (int i = 0; i < in_fours(n + 1); ++i) {
      const double dx = ax - x[i], dy = ay - y[i], square = rod2 - dx * dx - dy * dy;
      const double c = std::sqrt(square > 0 ? square : 0.0);
      q[i] = z[i] + c;
      inverse[i] = 1 / c;
    }
  }
  PASSO_SIMD static void speeds(int n, const Tower& tower, const double* __restrict x,
                                const double* __restrict y, const double* __restrict vx,
                                const double* __restrict vy, const double* __restrict vz,
                                const double* __restrict inverse, double* __restrict v) {
    const double ax = tower.x, ay = tower.y;
    for (int i = 0; i < in_fours(n); ++i)
      v[i] = vz[i] + ((ax - x[i]) * vx[i] + (ay - y[i]) * vy[i]) * inverse[i];
  }
  PASSO_SIMD static void middles(int n, const Tower& tower, const double* __restrict t,
                                 const double* __restrict x, const double* __restrict y,
                                 const double* __restrict z, const double* __restrict x0,
                                 const double* __restrict y0, const double* __restrict z0,
                                 const double* __restrict x1, const double* __restrict y1,
                                 const double* __restrict z1, double* __restrict q) {
    const double ax = tower.x, ay = tower.y, rod2 = tower.rod2;
    for (int i = 0; i < in_fours(n); ++i) {
      const double d = 0.125 * (t[i + 1] - t[i]);
      const double dx = ax - (0.5 * (x[i] + x[i + 1]) - d * (x1[i] - x0[i]));
      const double dy = ay - (0.5 * (y[i] + y[i + 1]) - d * (y1[i] - y0[i]));
      const double square = rod2 - dx * dx - dy * dy;
      q[i] = (0.5 * (z[i] + z[i + 1]) - d * (z1[i] - z0[i])) + std::sqrt(square > 0 ? square : 0.0);
    }
  }
  // Bounds of the derivatives of c with respect to time, from c^2 = rod^2 - u^2, for a speed V, an
  // acceleration A and a jerk J in XY:
  //   |c1| <= V u/c
  //   |c2| <= (V^2 rod^2/c^2 + A u) / c
  //   |c3| <= (3 (V A + |c1 c2|) + J u) / c
  //   |c4| <= (3 A^2 + 4 V J + 4 |c1 c3| + 3 c2^2) / c
  //   |c5| <= (10 A J + 5 |c1 c4| + 10 |c2 c3|) / c
  // For an interval of d ticks w = V d, g = A d^2 and j = J d^3. Within the interval u exceeds its
  // value at the ends by at most g/8.
  template <bool kCubic>
  PASSO_SIMD static void errors(int n, double rod2, const double* __restrict t,
                                const double* __restrict x, const double* __restrict y,
                                const double* __restrict vx0, const double* __restrict vy0,
                                const double* __restrict vx1, const double* __restrict vy1,
                                double* inverse) {
    const double rod = std::sqrt(rod2);
    for (int i = 0; i < in_fours(n); ++i) {
      const double d = t[i + 1] - t[i], gx = vx1[i] - vx0[i], gy = vy1[i] - vy0[i];
      const double at0 = vx0[i] * vx0[i] + vy0[i] * vy0[i];
      const double at1 = vx1[i] * vx1[i] + vy1[i] * vy1[i];
      double w = d * std::sqrt(at0 > at1 ? at0 : at1), g = d * std::sqrt(gx * gx + gy * gy), j = 0;
      if constexpr (kCubic) {
        const double jx = 6 * (d * (vx0[i] + vx1[i]) - 2 * (x[i + 1] - x[i]));
        const double jy = 6 * (d * (vy0[i] + vy1[i]) - 2 * (y[i + 1] - y[i]));
        j = std::sqrt(jx * jx + jy * jy);
        g += 0.5 * j, w += 0.125 * j;
      }
      const double most = inverse[i] > inverse[i + 1] ? inverse[i] : inverse[i + 1];
      const double square = 1 / (most * most),
                   least = square - rod * g;  // of c^2, at the ends and between them
      const double low = least > 0 ? 1 / least : kInfinity, per_c = most * square * low;
      const double slope = std::sqrt(rod2 - least) * per_c, c1 = slope * w;
      const double c2 = w * w * (rod2 * low * per_c) + slope * g;
      double c3 = 3 * (w * g + c1 * c2) * per_c, c4 = 3 * g * g, c5 = 0;
      if constexpr (kCubic) c3 += slope * j, c4 += 4 * w * j, c5 = 10 * g * j;
      c4 = (c4 + 4 * c1 * c3 + 3 * c2 * c2) * per_c;
      inverse[i] = kQuarticError * (c5 + 5 * c1 * c4 + 10 * c2 * c3) * per_c;
    }
  }
};

}  // namespace passo
