#include "filters/followed_nozzle.hpp"

#include <cmath>

#include "base/simd.hpp"

namespace passo {

namespace {

// Maximum error of the calculated law: the distance that the motor moves in kNearSeconds. Near a
// turn it is kNearSteps, which no pulse shows.
constexpr double kNearSeconds = 1e-10, kNearSteps = 1e-8;
constexpr double kMostOdd = 0.0481126;  // maximum of x (x - 1/2) (x - 1): sqrt(3) / 36

// Converts the actuator's units to steps, and its polynomial of degree four to a quadratic with
// bends. `error` becomes at most 0 where the result is exact enough.
PASSO_SIMD void fit_quadratics(int n, double per_unit, double near_ticks,
                               const double* __restrict t, const double* __restrict middle,
                               double* __restrict q, double* __restrict v0, double* __restrict v1,
                               double* __restrict a, double* __restrict odd,
                               double* __restrict even, double* __restrict error) {
  for (int i = 0; i < in_fours(n + 1); ++i) q[i] *= per_unit;
  for (int i = 0; i < in_fours(n); ++i) {
    const double d = t[i + 1] - t[i], per_tick = 1 / d;
    const double s0 = v0[i] * per_unit, s1 = v1[i] * per_unit, change = s1 - s0;
    const double mean = (q[i + 1] - q[i]) * per_tick;
    const double third = d * (s0 + s1 - 2 * mean);
    const double fourth = 16 * (middle[i] * per_unit - 0.5 * (q[i] + q[i + 1])) + 2 * d * change;
    const double f0 = std::fabs(s0), f1 = std::fabs(s1), least = f0 < f1 ? f0 : f1;
    const double slow = s0 * s1 > 0 ? least : 0.0, by_time = near_ticks * slow;
    const double near = by_time > kNearSteps ? by_time : kNearSteps;
    v0[i] = mean - 0.5 * change;
    v1[i] = mean + 0.5 * change;
    a[i] = change * per_tick;
    odd[i] = slow > 0 ? third : 0.0;
    even[i] = slow > 0 ? fourth : 0.0;
    // The error that remains after one step of Newton's method. If there may be a turn, the whole
    // bend counts.
    const double bent = kMostOdd * std::fabs(third) + 0.0625 * std::fabs(fourth);
    const double left = bent * bent * std::fabs(a[i]) - 2 * by_time * slow * slow;
    const double flat = bent - kNearSteps, far = error[i] * per_unit - near;
    const double none = left < flat ? left : flat;
    error[i] = none > far ? none : far;
  }
}

}  // namespace

void FollowedNozzle::fit(const Track& track, double near, Fit& to) const {
  to.law.reserve(track.n);
  const size_t room = to.law.q.size();
  for (auto* x : {&to.accel, &to.odd, &to.even}) x->resize(room);
  machine_.geometry->follow(spec_.index, track, to.law);
  fit_quadratics(int(track.n), spec_.steps_per_unit, kNearSeconds * machine_.clock_hz,
                 track.t.data(), to.law.middle.data(), to.law.q.data(), to.law.v0.data(),
                 to.law.v1.data(), to.accel.data(), to.odd.data(), to.even.data(),
                 to.law.error.data());
  if (machine_.geometry->turn(spec_.index) == 0) return;
  const double by =
      nearest_turn(*machine_.geometry, spec_.index, spec_.steps_per_unit, to.law.q[0], near) -
      to.law.q[0];
  for (size_t i = 0; i <= track.n; ++i) to.law.q[i] += by;
}

}  // namespace passo
