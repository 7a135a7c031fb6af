// All nonlinear geometries satisfy one condition: a point that moves with the nozzle stays at a
// given distance from a centre that the actuator moves,
//
//   |P(s) - C(q)|² = R²(q)
//
// For a delta C is on the tower; for arms C is the elbow on its circle. For a given q the condition
// is a quadratic in the path position s. So the position of a step needs no search:
// s = (-B ± sqrt(B² - λ(|P0 - C|² - R²))) / λ with λ = u·u and B = u·(P0 - C). The sign is that of
// (P - C)·u, which changes only where the actuator turns.
#pragma once
#include <algorithm>
#include <cmath>
#include <vector>

#include "base/numbers.hpp"
#include "base/simd.hpp"
#include "geometry/geometry.hpp"

namespace passo {

// The centre, R², and their first and second derivatives with respect to q.
struct Centre {
  double c[3], d[3], dd[3];
  double r2, r2d, r2dd;
};

// (±sqrt(square) - b) / λ, limited to `lo` … `hi`.
PASSO_INLINE double root_within(double b, double square, double inverse, double sign, double lo,
                                double hi) {
  square = square > 0 ? square : 0;
  double v = (sign * std::sqrt(square) - b) * inverse;
  v = v > lo ? v : lo;
  return v < hi ? v : hi;
}

PASSO_SIMD inline void sphere_roots(double* __restrict s, const double* __restrict cx,
                                    const double* __restrict cy, const double* __restrict cz,
                                    const double* __restrict r2, int n, double x, double y,
                                    double z, double ux, double uy, double uz, double sign,
                                    double lo, double hi) {
  double lambda = ux * ux + uy * uy + uz * uz, inverse = 1 / lambda;
  for (int j = 0; j < in_fours(n); ++j) {
    double dx = x - cx[j], dy = y - cy[j], dz = z - cz[j];
    double b = ux * dx + uy * dy + uz * dz;
    s[j] = root_within(b, b * b - lambda * (dx * dx + dy * dy + dz * dz - r2[j]), inverse, sign, lo,
                       hi);
  }
}

// Roots for centres one above the other, at heights c + dc j, with the same R. `flat`: part of B
// from X and Y; `across2`: their part of |P0 - C|².
PASSO_SIMD inline void lift_roots(double* __restrict s, int n, double z, double c, double dc,
                                  double uz, double flat, double across2, double r2, double lambda,
                                  double sign, double lo, double hi) {
  double inverse = 1 / lambda;
  for (int j = 0; j < in_fours(n); ++j) {
    double dz = z - (c + dc * j);
    double b = flat + uz * dz;
    s[j] = root_within(b, b * b - lambda * (across2 + dz * dz - r2), inverse, sign, lo, hi);
  }
}

// Whether no position is smaller than the one before it.
PASSO_SIMD inline bool ascending(const double* s, int n) {
  int falls = 0;
  for (int j = 1; j < n; ++j) falls |= s[j] < s[j - 1];
  return !falls;
}

// Kernel: void local(const double p[3], double out[3]): the point that moves with the nozzle,
// affine in p; double value(const double local[3]): q or NaN; Centre centre(double q); double
// sample_mm: the distance within which the actuator turns at most once; bool kLifts: C moves
// straight up, to height q, and R is constant. If kLifts is false: void centres(double q, double
// dq, int n, cx, cy, cz, r2): C and R² at in_fours(n) positions with equal distances.
template <class Kernel>
class SphereSolver {
 public:
  static double value(const Kernel& k, const double p[3]) {
    double local[3];
    k.local(p, local);
    return k.value(local);
  }

  static void slopes(const Kernel& k, const Path& path, double s, double& d1, double& d2) {
    Line line(k, path);
    double p[3], q = line.at(k, s, p);
    Centre c = k.centre(q);
    double fs = 0, fq = -c.r2d, fss = 0, fsq = 0, fqq = -c.r2dd, w[3];
    for (int j = 0; j < 3; ++j) {
      w[j] = p[j] - c.c[j];
      fs += 2 * w[j] * line.u[j];
      fss += 2 * line.u[j] * line.u[j];
    }
    if constexpr (Kernel::kLifts) {
      fq = -2 * w[2], fsq = -2 * line.u[2], fqq = 2;
    } else {
      for (int j = 0; j < 3; ++j) {
        fq -= 2 * w[j] * c.d[j];
        fsq -= 2 * line.u[j] * c.d[j];
        fqq += 2 * (c.d[j] * c.d[j] - w[j] * c.dd[j]);
      }
    }
    d1 = -fs / fq;
    d2 = -(fss + 2 * fsq * d1 + fqq * d1 * d1) / fq;
  }

  static void crossings(const Kernel& k, const Path& path, double per_unit, Crossings& out) {
    out.clear();
    Line line(k, path);
    int n = std::clamp(int(std::ceil(path.length / k.sample_mm)), 1, 4096);
    double from = 0, q, after_q, before = line.turn(k, 0, q);
    out.k0 = std::fabs(q) < 1e9 ? round_count(q * per_unit) : 0;
    for (int i = 1; i <= n; ++i) {
      double s = i == n ? path.length : path.length * i / n, after = line.turn(k, s, after_q);
      if (before * after < 0) {
        double turn = bracketed(k, line, path.length * (i - 1) / n, s, before, after), turn_q;
        line.turn(k, turn, turn_q);
        q = piece(k, line, from, turn, q, turn_q, before, per_unit, out);
        from = turn;
      }
      if (after != 0) before = after;
      if (i == n) piece(k, line, from, s, q, after_q, before, per_unit, out);
    }
  }

 private:
  struct Line {
    double p0[3], u[3], length;
    Line(const Kernel& k, const Path& path) : length(path.length) {
      double p1[3];
      k.local(path.p0, p0);
      k.local(path.p1, p1);
      for (int j = 0; j < 3; ++j) u[j] = (p1[j] - p0[j]) / length;
    }
    double at(const Kernel& k, double s, double p[3]) const {
      for (int j = 0; j < 3; ++j) p[j] = p0[j] + u[j] * s;
      return k.value(p);
    }
    // Returns (P - C)·u and sets q at s. The sign of the result says which root applies. It is 0
    // where the actuator turns.
    double turn(const Kernel& k, double s, double& q) const {
      double p[3];
      q = at(k, s, p);
      Centre c = k.centre(q);
      return (p[0] - c.c[0]) * u[0] + (p[1] - c.c[1]) * u[1] + (p[2] - c.c[2]) * u[2];
    }
  };

  // Illinois method: the root stays between a and b.
  static double bracketed(const Kernel& k, const Line& line, double a, double b, double fa,
                          double fb) {
    for (int i = 0; i < 60 && b - a > 1e-10; ++i) {
      double x = (a * fb - b * fa) / (fb - fa);
      if (!(x > a && x < b)) x = 0.5 * (a + b);
      double q, f = line.turn(k, x, q);
      if (f == 0) return x;
      if (f * fb < 0) {
        a = b;
        fa = fb;
      } else {
        fa *= 0.5;
      }
      b = x;
      fb = f;
      if (a > b) {
        std::swap(a, b);
        std::swap(fa, fb);
      }
    }
    return 0.5 * (a + b);
  }

  // Adds the crossings of a part without a turn, from q0 to q1. Returns q1.
  static double piece(const Kernel& k, const Line& line, double lo, double hi, double q0, double q1,
                      double side, double per_unit, Crossings& out) {
    if (!(std::fabs(q0) < 1e9 && std::fabs(q1) < 1e9)) return q1;
    int64_t k0 = round_count(q0 * per_unit), k1 = round_count(q1 * per_unit), steps = k1 - k0;
    if (steps == 0) return q1;
    int dir = steps > 0 ? 1 : -1;
    size_t n = size_t(steps * dir), first = out.s.size();
    if (out.runs.empty() || out.runs.back().dir != dir) out.runs.push_back({int32_t(first), dir});
    const size_t room = size_t(in_fours(int(n)));
    out.s.resize(first + room + 3);  // TimeLaw reads up to three elements past the end
    const double q = (double(k0) + 0.5 * dir) / per_unit, dq = dir / per_unit;
    const double sign = side > 0 ? 1 : -1, *p = line.p0, *u = line.u;
    double* s = out.s.data() + first;
    if constexpr (Kernel::kLifts) {
      const Centre c = k.centre(q);
      const double dx = p[0] - c.c[0], dy = p[1] - c.c[1];
      lift_roots(s, int(n), p[2], q, dq, u[2], u[0] * dx + u[1] * dy, dx * dx + dy * dy, c.r2,
                 u[0] * u[0] + u[1] * u[1] + u[2] * u[2], sign, lo, hi);
    } else {
      static thread_local UnsetDoubles buffer;
      buffer.resize(4 * room);
      double *cx = buffer.data(), *cy = cx + room, *cz = cy + room, *r2 = cz + room;
      k.centres(q, dq, int(n), cx, cy, cz, r2);
      sphere_roots(s, cx, cy, cz, r2, int(n), p[0], p[1], p[2], u[0], u[1], u[2], sign, lo, hi);
    }
    out.s.resize(first + n);
    if (!ascending(s, int(n)))  // because of rounding
      for (size_t j = 1; j < n; ++j) s[j] = std::max(s[j], s[j - 1]);
    return q1;
  }
};

// The lower intersection of three spheres with centres c and radii r; the upper one with `side` -1.
inline bool trilaterate(const double c[3][3], const double r[3], double p[3], double side = 1) {
  double ex[3], ey[3], ez[3], v[3], u = 0, i = 0, j = 0;
  for (int k = 0; k < 3; ++k) u += (c[1][k] - c[0][k]) * (c[1][k] - c[0][k]);
  u = std::sqrt(u);
  for (int k = 0; k < 3; ++k) ex[k] = (c[1][k] - c[0][k]) / u;
  for (int k = 0; k < 3; ++k) i += ex[k] * (c[2][k] - c[0][k]);
  for (int k = 0; k < 3; ++k) v[k] = c[2][k] - c[0][k] - i * ex[k];
  for (int k = 0; k < 3; ++k) j += v[k] * v[k];
  j = std::sqrt(j);
  for (int k = 0; k < 3; ++k) ey[k] = v[k] / j;
  for (int k = 0; k < 3; ++k)
    ez[k] = ex[(k + 1) % 3] * ey[(k + 2) % 3] - ex[(k + 2) % 3] * ey[(k + 1) % 3];
  double x = (r[0] * r[0] - r[1] * r[1] + u * u) / (2 * u);
  double y = (r[0] * r[0] - r[2] * r[2] + i * i + j * j - 2 * i * x) / (2 * j);
  double z2 = r[0] * r[0] - x * x - y * y;
  if (!(z2 >= 0)) return false;
  double z = (ez[2] > 0 ? -side : side) * std::sqrt(z2);
  for (int k = 0; k < 3; ++k) p[k] = c[0][k] + x * ex[k] + y * ey[k] + z * ez[k];
  return true;
}

}  // namespace passo
