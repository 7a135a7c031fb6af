// Polar: the bed turns about Z, and an arm moves the nozzle away from the middle of the bed. Z is
// independent.
#pragma once
#include "base/numbers.hpp"
#include "geometry/distance.hpp"

namespace passo {

class Polar : public Geometry {
 public:
  // Within `centre` mm of the middle the bed would have to turn at once.
  explicit Polar(double centre) : arm_{0, 0, 0, centre, true} {}
  int actuators() const override { return 3; }
  bool linear(int i, double c[3]) const override {
    c[0] = c[1] = 0;
    c[2] = 1;
    return i == kLift;
  }
  double turn(int i) const override { return i == kBed ? kTurn : 0; }
  double inverse(int i, const double p[3]) const override {
    if (i == kLift) return p[2];
    const double r = SphereSolver<Distance>::value(arm_, p);
    return i == kArm || !(r == r) ? r : angle(p);
  }
  bool forward(const double* q, double p[3]) const override {
    double s, c;
    sincos(q[kBed] * (kPi / 180), s, c);
    p[0] = q[kArm] * c;
    p[1] = q[kArm] * s;
    p[2] = q[kLift];
    return true;
  }
  // With the cross product c = P × u, which is the same along a line, the angle has the slope
  // c / r².
  void slopes(int i, const Path& path, double s, double& d1, double& d2) const override {
    if (i == kArm) return SphereSolver<Distance>::slopes(arm_, path, s, d1, d2);
    if (i == kLift) {
      d1 = (path.p1[2] - path.p0[2]) / path.length;
      d2 = 0;
      return;
    }
    const Line line(path);
    const double x = path.p0[0] + line.ux * s, y = path.p0[1] + line.uy * s, r2 = x * x + y * y;
    d1 = line.cross / r2 * (180 / kPi);
    d2 = -2 * line.cross * (x * line.ux + y * line.uy) / (r2 * r2) * (180 / kPi);
  }
  void crossings(int i, const Path& path, double per_unit, Crossings& out) const override {
    if (i == kArm)
      SphereSolver<Distance>::crossings(arm_, path, per_unit, out);
    else
      turns(path, per_unit, out);
  }
  double grain(const double p[3], double around) const override { return arm_.grain(p, around); }
  // The way round the middle is on the side of the line, so that the bed turns as it would.
  bool leads_round(const double from[3], const double to[3], double via[3],
                   double& share) const override {
    const double dx = to[0] - from[0], dy = to[1] - from[1], mm2 = dx * dx + dy * dy;
    share = -(from[0] * dx + from[1] * dy) / mm2;
    if (!(share > 0 && share < 1)) return false;
    const double x = from[0] + share * dx, y = from[1] + share * dy, off = std::sqrt(x * x + y * y);
    if (off >= arm_.near) return false;
    const double mm = std::sqrt(mm2), away = 2 * arm_.near, tiny = 1e-9;
    via[0] = off > tiny ? x / off * away : -dy / mm * away;
    via[1] = off > tiny ? y / off * away : dx / mm * away;
    via[2] = from[2] + share * (to[2] - from[2]);
    return true;
  }

 private:
  static constexpr int kBed = 0, kArm = 1, kLift = 2;
  static constexpr double kTurn = 360;
  Distance arm_;

  struct Line {
    double ux, uy, cross;
    explicit Line(const Path& path)
        : ux((path.p1[0] - path.p0[0]) / path.length), uy((path.p1[1] - path.p0[1]) / path.length),
          cross(path.p0[0] * uy - path.p0[1] * ux) {}
  };
  // Degrees, within half a turn.
  static double angle(const double p[3]) { return atan2(p[1], p[0]) * (180 / kPi); }

  // Along a line the angle goes in one direction, by less than half a turn. It is θ where
  // (x sin θ - y cos θ) + s (ux sin θ - uy cos θ) = 0.
  static void turns(const Path& path, double per_unit, Crossings& out) {
    out.clear();
    const Line line(path);
    double from = angle(path.p0), by = angle(path.p1) - from;
    from += kTurn * std::floor((out.near / per_unit - from) / kTurn + 0.5);
    by -= kTurn * std::floor(by / kTurn + 0.5);
    if (line.cross > 0 && by < -0.25 * kTurn) by += kTurn;
    if (line.cross < 0 && by > 0.25 * kTurn) by -= kTurn;
    if (!(std::fabs(by) < kTurn)) return;
    out.k0 = round_count(from * per_unit);
    const int64_t steps = round_count((from + by) * per_unit) - out.k0;
    if (steps == 0) return;
    const int dir = steps > 0 ? 1 : -1, n = int(steps * dir);
    out.runs.push_back({0, dir});
    const size_t room = size_t(in_fours(n));
    out.s.resize(room + 3);  // TimeLaw reads up to three elements past the end
    static thread_local UnsetDoubles buffer;
    buffer.resize(2 * room);
    double *sine = buffer.data(), *cosine = sine + room;
    sincos_even((double(out.k0) + 0.5 * dir) / per_unit * (kPi / 180), dir / per_unit * (kPi / 180),
                n, sine, cosine);
    const double x = path.p0[0], y = path.p0[1];
    double least = 0;
    for (int j = 0; j < n; ++j) {
      const double s = (y * cosine[j] - x * sine[j]) / (line.ux * sine[j] - line.uy * cosine[j]);
      if (s > least) least = std::min(s, path.length);  // not a number: rounding
      out.s[size_t(j)] = least;
    }
    out.s.resize(size_t(n));
  }
};

}  // namespace passo
