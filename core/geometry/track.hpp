// The path of the nozzle in time, and the position of one actuator along it.
#pragma once
#include <algorithm>
#include <cstddef>

#include "base/uninitialised_vector.hpp"

namespace passo {

// X, Y and Z are quadratics or cubics of time between breakpoints j and j + 1. Speeds are those
// within the interval, because they may jump at a breakpoint. No interval has length 0.
struct Track {
  size_t n = 0;                       // number of intervals
  bool cubic = false;                 // some intervals may be cubics
  UnsetDoubles t, p[3];               // of n + 1 breakpoints: ticks, mm
  UnsetDoubles v0[3], v1[3];          // of n intervals, at start and end: mm/tick
  static constexpr size_t kRoom = 8;  // loops over four elements read past the end

  void reserve(size_t intervals) {
    const size_t wanted = intervals + kRoom;
    if (t.size() >= wanted) return;
    t.resize(wanted);
    for (int j = 0; j < 3; ++j)
      for (auto* x : {&p[j], &v0[j], &v1[j]}) x->resize(wanted);
  }
  // Fills the elements past the end with valid numbers.
  void finish() {
    for (size_t i = n; i < n + kRoom - 1; ++i) {
      t[i + 1] = t[n];
      for (int j = 0; j < 3; ++j) p[j][i + 1] = p[j][n], v0[j][i] = v1[j][i] = 0;
    }
  }
  // Coefficient of u^3 of slot k in interval j, where u goes from 0 to 1.
  double third(size_t k, size_t j) const {
    return (t[j + 1] - t[j]) * (v0[k][j] + v1[k][j]) - 2 * (p[k][j + 1] - p[k][j]);
  }
  // Sets this track to interval j of another one, divided into equal parts.
  void divide(const Track& of, size_t j, size_t parts) {
    reserve(parts);
    n = parts;
    cubic = of.cubic;
    const double d = of.t[j + 1] - of.t[j];
    for (size_t i = 0; i <= parts; ++i) {
      const double u = double(i) / double(parts);
      t[i] = i == parts ? of.t[j + 1] : of.t[j] + u * d;
      for (int k = 0; k < 3; ++k) {
        const double a = of.v1[k][j] - of.v0[k][j], third = cubic ? of.third(k, j) : 0;
        const double v = of.v0[k][j] + a * u + (cubic ? 3 * third * u * (u - 1) / d : 0);
        p[k][i] = i == parts ? of.p[k][j + 1]
                             : of.p[k][j] + u * d * (of.v0[k][j] + 0.5 * a * u) +
                                   third * u * u * (u - 1.5);
        if (i < parts) v0[k][i] = v;
        if (i > 0) v1[k][i - 1] = v;
      }
    }
    finish();
  }
};

// Motion of one actuator in its unit: positions at the breakpoints and in the middle of the
// intervals, and speeds at both ends of the intervals. `error` is the maximum distance from the
// polynomial of degree four through these values.
struct Followed {
  UnsetDoubles q, middle, v0, v1, error;
  void reserve(size_t intervals) {
    const size_t wanted = intervals + Track::kRoom;
    if (q.size() < wanted)
      for (auto* x : {&q, &middle, &v0, &v1, &error}) x->resize(wanted);
  }
};

// The distance from that polynomial is at most this times the fifth derivative times d^5. With x
// from 0 to 1 it is 1/120 of x^2 (x - 1/2) (x - 1)^2, which is at most 1 / (50 sqrt 5).
inline constexpr double kQuarticError = 7.4536e-5;

}  // namespace passo
