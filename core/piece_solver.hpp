// The steps of one motor along pieces.
#pragma once
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "crossings.hpp"
#include "machine.hpp"
#include "pieces.hpp"

namespace passo {

class PieceSolver {
 public:
  PieceSolver(const Machine& machine, const StepperSpec& spec) : machine_(machine), spec_(spec) {
    for (double& c : row_) c = 0;
    if (spec.drive == Drive::actuator)
      straight_ = machine.geometry->linear(spec.index, row_);
    else
      row_[spec.drive == Drive::extruder ? kE : slot_of_axis(spec.index)] = 1;
  }

  // Calls step(ticks, direction) for each step from `count` on, and once more for each that the
  // rounded end, `target`, still wants. Returns `target`.
  template <class Step>
  int64_t solve(const Piece& p, int64_t count, int64_t target, Step&& step) {
    if (!moves(p)) return count;
    return straight_ ? solve_along(Straight(*this, p), p, 1, count, target, step)
                     : solve_along(Curved(*this, p), p, parts(p), count, target, step);
  }

  // Throws std::invalid_argument if the motor cannot reach a position, or not so fast. Looked at
  // each kSampleMm, and at kLeastSamples times at least.
  void check(const Piece& p) const {
    if (!moves(p)) return;
    int n = std::max(parts(p), kLeastSamples);
    for (int i = 0; i <= n; ++i) {
      double t = p.seconds * i / n;
      double q = straight_ ? Straight(*this, p).value(t) : Curved(*this, p).value(t);
      double rate = straight_ ? Straight(*this, p).slope(t) : Curved(*this, p).slope(t);
      q /= spec_.steps_per_unit;
      // Written so that a position that is none fails too.
      if (!(q >= spec_.min - 1e-6 && q <= spec_.max + 1e-6))
        throw std::invalid_argument("a piece leaves the reach of stepper " + spec_.name);
      if (!(std::fabs(rate) <= spec_.max_rate))
        throw std::invalid_argument("a piece is too fast for stepper " + spec_.name);
    }
  }

 private:
  static constexpr double kSampleMm = 1;  // within which an actuator turns at most twice
  static constexpr int kLeastSamples = 16;
  static constexpr double kExact = 1e-3;  // steps: a turn forth and back by less may be missed

  const Machine& machine_;
  const StepperSpec& spec_;
  bool straight_ = true;
  double row_[kAxes];  // of a straight motor: its position by those of the axes
  std::vector<double> turns_;

  bool moves(const Piece& p) const {
    return spec_.drive != Drive::extruder || p.extruder == spec_.index;
  }
  static int parts(const Piece& p) {
    return std::clamp(int(std::ceil(std::min(p.longest_way() / kSampleMm, 4096.0))), 1, 4096);
  }

  // Position in steps over the seconds of a piece.
  struct Straight {
    double k[Piece::kTerms];
    Straight(const PieceSolver& s, const Piece& p) {
      for (int i = 0; i < Piece::kTerms; ++i) {
        k[i] = 0;
        for (int j = 0; j < kAxes; ++j)
          if (s.row_[j] != 0) k[i] += s.row_[j] * p.c[j][i];
        k[i] *= s.spec_.steps_per_unit;
      }
    }
    double value(double t) const { return Piece::at(k, t); }
    double slope(double t) const { return Piece::slope_at(k, t); }
  };
  struct Curved {
    const PieceSolver& s;
    const Piece& p;
    Curved(const PieceSolver& solver, const Piece& piece) : s(solver), p(piece) {}
    double value(double t) const {
      double point[3] = {p.position(kX, t), p.position(kY, t), p.position(kZ, t)};
      return s.machine_.geometry->inverse(s.spec_.index, point) * s.spec_.steps_per_unit;
    }
    // By path position along the tangent, which passes one unit in a second.
    double slope(double t) const {
      Path tangent{{}, {}, 1};
      for (int j = 0; j < 3; ++j) {
        tangent.p0[j] = p.position(j, t);
        tangent.p1[j] = tangent.p0[j] + p.speed(j, t);
      }
      double first, second;
      s.machine_.geometry->slopes(s.spec_.index, tangent, 0, first, second);
      return first * s.spec_.steps_per_unit;
    }
  };

  template <class Curve, class Step>
  int64_t solve_along(const Curve& curve, const Piece& p, int parts, int64_t count, int64_t target,
                      Step&& step) {
    turns_.clear();
    Turns<Curve> turns(curve, kExact, turns_);
    for (int i = 0; i < parts; ++i) turns.find(p.seconds * i / parts, p.seconds * (i + 1) / parts);
    double t = 0;
    for (size_t i = 0; i < turns_.size(); ++i) {
      bool last = i + 1 == turns_.size();
      int64_t to = last ? target : int64_t(std::floor(curve.value(turns_[i]) + 0.5));
      int dir = to > count ? 1 : -1;
      for (; count != to; count += dir) {
        t = crossing(curve, double(count) + 0.5 * dir, dir, t, turns_[i]);
        step(p.start + t * machine_.clock_hz, dir);
      }
      t = turns_[i];
    }
    return count;
  }
};

}  // namespace passo
