#include "geometry/track.hpp"

#include <algorithm>
#include <cmath>

#include "base/types.hpp"
#include "geometry/geometry.hpp"

namespace passo {

void Geometry::follow(int i, const Track& track, Followed& out) const {
  constexpr double kFarthestMm = 1;  // within this an actuator turns at most twice
  out.reserve(track.n);
  auto place = [&](const double at[3], double& q) {
    const double found = inverse(i, at);
    // Out of reach the actuator stays.
    if (found == found) q = nearest_turn(*this, i, 1, found, q);
  };
  auto speed = [&](const double at[3], const double v[3]) {
    const Path tangent{{at[0], at[1], at[2]}, {at[0] + v[0], at[1] + v[1], at[2] + v[2]}, 1};
    double first, second;
    slopes(i, tangent, 0, first, second);
    return first == first ? first : 0.0;
  };
  double to[3] = {track.p[0][0], track.p[1][0], track.p[2][0]}, q = 0;
  place(to, q);
  out.q[0] = q;
  for (size_t k = 0; k < track.n; ++k) {
    const double d = track.t[k + 1] - track.t[k];
    double from[3], half[3], v0[3], v1[3], mean[3], square0 = 0, square1 = 0;
    for (size_t j = 0; j < 3; ++j) {
      from[j] = to[j], to[j] = track.p[j][k + 1];
      v0[j] = track.v0[j][k], v1[j] = track.v1[j][k];
      mean[j] = 0.5 * (v0[j] + v1[j]);
      if (track.cubic) mean[j] = 1.5 * (to[j] - from[j]) / d - 0.5 * mean[j];
      half[j] = 0.5 * (from[j] + to[j]) - 0.125 * d * (v1[j] - v0[j]);
      square0 += v0[j] * v0[j], square1 += v1[j] * v1[j];
    }
    const double before = q;
    double middle = q;
    place(half, middle);
    place(to, q);
    const double s0 = speed(from, v0), s = speed(half, mean), s1 = speed(to, v1);
    out.q[k + 1] = q, out.v0[k] = s0, out.v1[k] = s1;
    out.middle[k] = middle;
    // The fifth derivative changes the speed in the middle by seven times the largest error of the
    // position.
    const double off = s - 1.5 * (q - before) / d + 0.25 * (s0 + s1);
    const bool far = std::max(square0, square1) * d * d > kFarthestMm * kFarthestMm;
    out.error[k] = far ? kInfinity : 0.5 * std::fabs(off) * d;
  }
}

}  // namespace passo
