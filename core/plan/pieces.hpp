// The second kind of input of the step solver: intervals in which the position of each axis is a
// polynomial of time. Motion filters turn trapezoids of speed into such pieces.
#pragma once
#include <cmath>
#include <cstdint>

#include "base/types.hpp"

namespace passo {

struct Piece {
  static constexpr int kTerms = 6;  // degree 5
  double start;                     // ticks since the start of the job
  double seconds;                   // > 0
  double c[kAxes][kTerms];          // position of an axis = Σ c[k] t^k mm, t in s from `start`
  double end[kAxes];                // its exact end, from which the last step is rounded
  uint16_t extruder;                // that moves by c[kE]

  static double at(const double* k, double t) {
    return ((((k[5] * t + k[4]) * t + k[3]) * t + k[2]) * t + k[1]) * t + k[0];
  }
  static double slope_at(const double* k, double t) {
    return (((5 * k[5] * t + 4 * k[4]) * t + 3 * k[3]) * t + 2 * k[2]) * t + k[1];
  }
  double position(int axis, double t) const { return at(c[axis], t); }
  double speed(int axis, double t) const { return slope_at(c[axis], t); }
  // The highest power of t in X, Y and Z.
  int degree() const {
    for (int k = kTerms - 1; k > 0; --k)
      if (c[kX][k] != 0 || c[kY][k] != 0 || c[kZ][k] != 0) return k;
    return 0;
  }
  // Length of the path in X, Y, Z, by chords: a polynomial has too few bends to differ much from
  // them.
  double length_mm() const {
    constexpr int kChords = 32;
    double sum = 0, from[3] = {c[kX][0], c[kY][0], c[kZ][0]};
    for (int i = 1; i <= kChords; ++i) {
      double square = 0;
      for (int j = 0; j < 3; ++j) {
        double to = position(j, seconds * i / kChords);
        square += (to - from[j]) * (to - from[j]);
        from[j] = to;
      }
      sum += std::sqrt(square);
    }
    return sum;
  }
};

}  // namespace passo
