// Sine, cosine and arctangent, the same bits on every CPU: made of + - * / and sqrt only.
//
// Polynomials: the minimax coefficients that Sun published with fdlibm (1993) for sin and cos on
// |x| ≤ π/4 and for atan on |x| ≤ 7/16; reduction in the manner of Cody and Waite. Errors stay
// below 1 ulp, of sin and cos for |x| < 1e6 (tests/core/test_numbers.py measures them).
#pragma once
#include <cmath>
#include <cstdint>

#include "base/simd.hpp"

namespace passo {

inline constexpr double kPi = 3.14159265358979311600e+00;

namespace detail {

inline constexpr double kTwoOverPi = 6.36619772367581382433e-01;
inline constexpr double kHalfPi1 = 1.57079632673412561417e+00;  // first 33 bits of π/2
inline constexpr double kHalfPi2 = 6.07710050630396597660e-11;  // next 33 bits
inline constexpr double kHalfPi3 = 2.02226624879595063154e-21;  // the rest

// sin(x + y) and cos(x + y) for |x| ≤ π/4, y the tail of x.
PASSO_INLINE double sin_kernel(double x, double y) {
  double z = x * x, v = z * x;
  double r = 8.33333333332248946124e-03 +
             z * (-1.98412698298579493134e-04 +
                  z * (2.75573137070700676789e-06 +
                       z * (-2.50507602534068634195e-08 + z * 1.58969099521155010221e-10)));
  return x - ((z * (0.5 * y - v * r) - y) - v * -1.66666666666666324348e-01);
}
PASSO_INLINE double cos_kernel(double x, double y) {
  double z = x * x;
  double r =
      z * (4.16666666666666019037e-02 +
           z * (-1.38888888888741095749e-03 +
                z * (2.48015872894767294178e-05 +
                     z * (-2.75573143513906633035e-07 +
                          z * (2.08757232129817482790e-09 + z * -1.13596475577881948265e-11)))));
  double half = 0.5 * z, w = 1.0 - half;
  return w + (((1.0 - w) - half) + (z * r - x * y));
}

}  // namespace detail

inline void sincos(double x, double& s, double& c) {
  using namespace detail;
  double n = round_even(x * kTwoOverPi);
  double a = x - n * kHalfPi1, b = n * kHalfPi2, r = a - b;
  double tail = ((a - r) - b) - n * kHalfPi3;
  double y0 = r + tail, y1 = (r - y0) + tail;
  double sine = detail::sin_kernel(y0, y1), cosine = detail::cos_kernel(y0, y1);
  switch (int64_t(n) & 3) {
    case 0:
      s = sine;
      c = cosine;
      break;
    case 1:
      s = cosine;
      c = -sine;
      break;
    case 2:
      s = -sine;
      c = -cosine;
      break;
    default:
      s = -cosine;
      c = sine;
      break;
  }
}

// Sine and cosine of x0 + dx*j for j < in_fours(n): the same bits as sincos, several lanes at a
// time.
PASSO_SIMD inline void sincos_even(double x0, double dx, int n, double* __restrict sines,
                                   double* __restrict cosines) {
  for (int j = 0; j < in_fours(n); ++j) {
    double x = x0 + dx * j;
    double shifted = x * detail::kTwoOverPi + kRoundMagic, count = shifted - kRoundMagic;
    double a = x - count * detail::kHalfPi1, b = count * detail::kHalfPi2, r = a - b;
    double tail = ((a - r) - b) - count * detail::kHalfPi3;
    double y0 = r + tail, y1 = (r - y0) + tail;
    double sine = detail::sin_kernel(y0, y1), cosine = detail::cos_kernel(y0, y1);
    int64_t quarter = std::bit_cast<int64_t>(shifted);
    double s = quarter & 1 ? cosine : sine, c = quarter & 1 ? sine : cosine;
    sines[j] = quarter & 2 ? -s : s;
    cosines[j] = (quarter + 1) & 2 ? -c : c;
  }
}

namespace detail {

// atan(t + tail) = high + the value returned, t ≥ 0.
inline double atan_parts(double t, double tail, double& high) {
  constexpr double kHigh[] = {4.63647609000806093515e-01, 7.85398163397448278999e-01,
                              9.82793723247329054082e-01, 1.57079632679489655800e+00};
  constexpr double kLow[] = {2.26987774529616870924e-17, 3.06161699786838301793e-17,
                             1.39033110312309984516e-17, 6.12323399573676603587e-17};
  double a = t, low = tail / (1 + t * t);
  high = 0;
  if (t >= 0.4375) {
    int piece;
    if (t < 0.6875)
      piece = 0, a = (2.0 * t - 1.0) / (2.0 + t);
    else if (t < 1.1875)
      piece = 1, a = (t - 1.0) / (t + 1.0);
    else if (t < 2.4375)
      piece = 2, a = (t - 1.5) / (1.0 + 1.5 * t);
    else
      piece = 3, a = -1.0 / t;
    high = kHigh[piece];
    low += kLow[piece];
  }
  double z = a * a, w = z * z;
  double even =
      z * (3.33333333333329318027e-01 +
           w * (1.42857142725034663711e-01 +
                w * (9.09088713343650656196e-02 +
                     w * (6.66107313738753120669e-02 +
                          w * (4.97687799461593236017e-02 + w * 1.62858201153657823623e-02)))));
  double odd =
      w * (-1.99999999998764832476e-01 +
           w * (-1.11111104054623557880e-01 +
                w * (-7.69187620504482999495e-02 +
                     w * (-5.83357013379057348645e-02 + w * -3.65315727442169155270e-02))));
  return a - (a * (even + odd) - low);
}

// a - b * c without the error of the product (Dekker), for |b|, |c| < 1e290.
inline double remainder(double a, double b, double c) {
  constexpr double kSplit = 134217729;  // 2^27 + 1
  double bs = b * kSplit, cs = c * kSplit;
  double b1 = bs - (bs - b), b2 = b - b1, c1 = cs - (cs - c), c2 = c - c1;
  return (((a - b1 * c1) - b1 * c2) - b2 * c1) - b2 * c2;
}

}  // namespace detail

inline double atan2(double y, double x) {
  constexpr double kPiLow = 1.2246467991473531772e-16;
  if (x == 0 && y == 0) return 0;
  double up = std::fabs(y), along = std::fabs(x), t = up / along;
  double tail = t < 1e18 ? detail::remainder(up, t, along) / along : 0;
  double high, rest = detail::atan_parts(t, tail, high);
  if (x < 0) {
    double acute = high;
    high = kPi - acute;
    rest = ((kPi - high) - acute + kPiLow) - rest;
  }
  double angle = high + rest;
  return y < 0 ? -angle : angle;
}

// Arc cosine of |x| ≤ 1.
inline double acos(double x) { return atan2(std::sqrt((1 - x) * (1 + x)), x); }

// The step count of a position: half a step rounds up.
inline int64_t round_count(double position) { return int64_t(std::floor(position + 0.5)); }

}  // namespace passo
