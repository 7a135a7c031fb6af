// The ideal time of every step of one motor, from planned moves. Times are ticks since the start of
// the job, unrounded.
#pragma once
#include <algorithm>
#include <cmath>
#include <vector>

#include "base/simd.hpp"
#include "base/uninitialised_vector.hpp"
#include "machine/machine.hpp"
#include "plan/move.hpp"
#include "steps/piece_solver.hpp"

namespace passo {

// Steps in order of time. A run is a stretch of one direction.
struct Steps {
  struct Run {
    size_t first;  // index in `ticks`
    int dir;       // +1 or -1
  };
  struct Widening {
    size_t first;      // index in `ticks`
    double tolerance;  // ticks; 0: the board's own
  };
  UnsetDoubles ticks;
  std::vector<Run> runs;
  std::vector<Widening> widenings;  // where the tolerance changes, from the board's own at first

  // The steps to come have this tolerance.
  void set_tolerance(double tolerance) {
    if ((widenings.empty() ? 0 : widenings.back().tolerance) == tolerance) return;
    if (!widenings.empty() && widenings.back().first == ticks.size()) widenings.pop_back();
    widenings.push_back({ticks.size(), tolerance});
  }
  // The n ticks from index `from` on are taken out, or n ticks in front of all.
  void move_widenings(size_t from, size_t n) {
    for (Widening& w : widenings)
      if (w.first > from) w.first = std::max(w.first - std::min(n, w.first), from);
    while (widenings.size() > 1 && widenings[1].first <= 1) widenings.erase(widenings.begin());
  }
};

// t[j] = base + sign * sqrt(c0 + c1 * j)
PASSO_SIMD inline void fill_root(double* __restrict t, int n, double c0, double c1, double base,
                                 double sign) {
  for (int j = 0; j < in_fours(n); ++j) t[j] = base + sign * std::sqrt(std::max(0.0, c0 + c1 * j));
}
PASSO_SIMD inline void fill_line(double* __restrict t, int n, double c0, double c1) {
  for (int j = 0; j < in_fours(n); ++j) t[j] = c0 + c1 * j;
}
// The same for path positions s[j] that are not evenly spaced.
PASSO_SIMD inline void fill_root_at(double* __restrict t, const double* __restrict s, int n,
                                    double c0, double c1, double base, double sign) {
  for (int j = 0; j < in_fours(n); ++j)
    t[j] = base + sign * std::sqrt(std::max(0.0, c0 + c1 * s[j]));
}
PASSO_SIMD inline void fill_line_at(double* __restrict t, const double* __restrict s, int n,
                                    double c0, double c1) {
  for (int j = 0; j < in_fours(n); ++j) t[j] = c0 + c1 * s[j];
}
// How many of them are below the limit.
PASSO_SIMD inline int count_below(double limit, const double* s, int n) {
  int below = 0;
  for (int j = 0; j < n; ++j) below += s[j] < limit;
  return below;
}

// Time law of a move as t(s): in each phase base + sign*sqrt(c0 + c1*s), or a line while cruising.
struct TimeLaw {
  double base0, sign0, c00, c01;  // first phase, s < s1
  double line0, line1;            // cruise, s < s2
  double base2, c20, c21;         // last phase, measured from the end so that v → 0 is harmless
  double s1, s2;

  TimeLaw(const Move& m, double hz) {
    double w0 = hz / m.a, w2 = hz / m.b;
    base0 = m.start - m.v0 * w0;
    sign0 = m.a > 0 ? 1 : -1;
    c00 = (m.v0 * w0) * (m.v0 * w0);
    c01 = 2 * w0 * hz;
    s1 = m.d_acc;
    s2 = m.d_acc + m.d_cru;
    double per = m.vc > 0 ? hz / m.vc : 0;
    line1 = per;
    line0 = m.start + m.t_acc - m.d_acc * per;
    base2 = m.end() + m.v1 * w2;
    c20 = (m.v1 * w2) * (m.v1 * w2) + 2 * w2 * hz * m.d;
    c21 = -2 * w2 * hz;
  }

  // n evenly spaced positions s0 + ds*j, ascending. Here and below `t` and `s` must go on for three
  // more; what is there is overwritten, and read.
  void even(double s0, double ds, int n, double* t) const {
    int n1 = below(s1, s0, ds, n), n2 = below(s2, s0, ds, n);
    if (n1 > 0) fill_root(t, n1, c00 + c01 * s0, c01 * ds, base0, sign0);
    if (n2 > n1) fill_line(t + n1, n2 - n1, line0 + line1 * (s0 + n1 * ds), line1 * ds);
    if (n > n2) fill_root(t + n2, n - n2, c20 + c21 * (s0 + n2 * ds), c21 * ds, base2, -1);
  }
  // n ascending positions, one at least.
  void at(const double* s, int n, double* t) const {
    const int n1 = number_below(s1, s, n), n2 = std::max(n1, number_below(s2, s, n));
    if (n1 > 0) fill_root_at(t, s, n1, c00, c01, base0, sign0);
    if (n2 > n1) fill_line_at(t + n1, s + n1, n2 - n1, line0, line1);
    if (n > n2) fill_root_at(t + n2, s + n2, n - n2, c20, c21, base2, -1);
  }

 private:
  // Of n ascending positions, one at least. Mostly of few, and then as good as random how many: a
  // search would branch on that.
  static int number_below(double limit, const double* s, int n) {
    if (limit <= s[0]) return 0;
    if (limit > s[n - 1]) return n;
    return count_below(limit, s, n);
  }
  static int below(double limit, double s0, double ds, int n) {
    double k = (limit - s0) / ds;
    return k <= 0 ? 0 : k >= n ? n : int(std::ceil(k));
  }
};

class StepSolver {
 public:
  StepSolver(const Machine& machine, const StepperSpec& spec)
      : machine_(machine), spec_(spec), hz_(machine.clock_hz), pieces_(machine, spec) {
    for (double& c : c_) c = 0;
    linear_ = true;
    if (spec.drive == Drive::extruder) {
      axis_ = kE;
    } else if (spec.drive == Drive::axis) {
      axis_ = slot_of_axis(spec.index);
    } else {
      linear_ = machine.geometry->linear(spec.index, c_);
    }
  }

  int64_t count() const { return count_; }  // steps from the origin, after the moves solved so far
  void set_count(int64_t count) { count_ = count; }

  // Step count at a position: the target of every move is rounded from the absolute position.
  int64_t count_at(const double* p) const { return int64_t(std::floor(position(p) + 0.5)); }

  // Appends the steps of the move.
  void solve(const Move& m, Steps& out) {
    if (spec_.drive == Drive::extruder && m.extruder != spec_.index) return;
    if (m.kind == MoveKind::dwell) return;
    out.set_tolerance(m.tolerance);
    // Also by less than what measures the path: by a hair beside much filament.
    bool travels = m.p0[kX] != m.p1[kX] || m.p0[kY] != m.p1[kY] || m.p0[kZ] != m.p1[kZ];
    if (travels && pieces_.raised())
      solve_raised(m, out);
    else if (linear_ || machine_.joints)
      solve_linear(m, out);
    else if (travels)
      solve_path(m, out);
  }

  // Appends the steps of the piece.
  void solve(const Piece& p, Steps& out) {
    out.set_tolerance(0);
    auto step = [&out](double ticks, int dir) { *extend(out, 1, dir) = ticks; };
    count_ = pieces_.solve(p, count_, count_at(p.end), true, step);
  }

 private:
  const Machine& machine_;
  const StepperSpec& spec_;
  double hz_;
  bool linear_;
  int axis_ = -1;  // ≥ 0: of an axis or extruder, whose motor this is
  double c_[3];
  int64_t count_ = 0;
  Crossings crossings_;
  std::vector<double> owed_;  // path positions
  PieceSolver pieces_;

  double position(const double* p) const {
    if (machine_.joints && spec_.drive == Drive::actuator)
      return p[spec_.index] * spec_.steps_per_unit;
    if (axis_ >= 0) return p[axis_] * spec_.steps_per_unit;
    double at[3] = {p[0], p[1], pieces_.raised() ? machine_.raised(p) : p[2]};
    if (linear_) return (c_[0] * at[0] + c_[1] * at[1] + c_[2] * at[2]) * spec_.steps_per_unit;
    return machine_.geometry->inverse(spec_.index, at) * spec_.steps_per_unit;
  }

  static double* extend(Steps& out, size_t n, int dir) {
    // TimeLaw writes up to three behind them, the compressor puts one there.
    size_t first = out.ticks.size(), wanted = first + n + 4;
    if (out.ticks.capacity() < wanted)
      out.ticks.reserve(std::max(wanted, out.ticks.capacity() * 3 / 2));
    if (out.runs.empty() || out.runs.back().dir != dir) out.runs.push_back({first, dir});
    out.ticks.resize(first + n);
    return out.ticks.data() + first;
  }

  void solve_linear(const Move& m, Steps& out) {
    double from = position(m.p0), to = position(m.p1);
    int64_t target = int64_t(std::floor(to + 0.5)), n = target - count_;
    if (n == 0) return;
    double dir = n > 0 ? 1 : -1;
    n = n > 0 ? n : -n;
    double per_step = from == to ? 0 : m.d / std::fabs(to - from);
    double s0 = (double(count_) + 0.5 * dir - from) * dir * per_step;
    double* t = extend(out, size_t(n), int(dir));
    TimeLaw(m, hz_).even(s0, std::max(per_step, 1e-12), int(n), t);
    // After a cut: what was due before it comes at once.
    for (int64_t k = 0; k < n && s0 + per_step * double(k) < 0; ++k) t[k] = m.start;
    count_ = target;
  }

  // Above a bed that is not flat: the phases of the move as pieces.
  void solve_raised(const Move& m, Steps& out) {
    auto step = [&out](double ticks, int dir) { *extend(out, 1, dir) = ticks; };
    int64_t target = count_at(m.p1);
    double d_dec = m.d - m.d_acc - m.d_cru, begin[] = {0, m.d_acc, m.d_acc + m.d_cru};
    double ticks[] = {m.t_acc, m.t_cru, m.t_dec}, way[] = {m.d_acc, m.d_cru, d_dec};
    double speed[] = {m.v0, m.vc, m.vc}, accel[] = {m.a, 0, -m.b}, start = m.start;
    int last = m.t_dec > 0 ? 2 : m.t_cru > 0 ? 1 : 0;
    for (int i = 0; i <= last; start += ticks[i++]) {
      if (!(ticks[i] > 0 && way[i] > 0) && i < last) continue;
      Piece p{};
      p.start = start;
      p.seconds = ticks[i] / hz_;
      p.extruder = m.extruder;
      for (int j = 0; j < 3; ++j) {
        double u = (m.p1[j] - m.p0[j]) / m.d;
        p.c[j][0] = m.p0[j] + u * begin[i];
        p.c[j][1] = u * speed[i];
        p.c[j][2] = 0.5 * u * accel[i];
      }
      count_ = pieces_.solve(p, count_, target, i == last, step);
    }
  }

  void solve_path(const Move& m, Steps& out) {
    Path path{{m.p0[0], m.p0[1], m.p0[2]}, {m.p1[0], m.p1[1], m.p1[2]}, m.d};
    machine_.geometry->crossings(spec_.index, path, spec_.steps_per_unit, crossings_);
    TimeLaw law(m, hz_);
    // After a cut: steps done before their ideal time, which are not done again, or still owed.
    int64_t ahead = count_ - crossings_.k0;
    auto owe = [&](double s) {
      size_t n = size_t(std::abs(ahead));
      owed_.assign(n + 3, s);
      law.at(owed_.data(), int(n), extend(out, n, ahead > 0 ? -1 : 1));
      count_ -= ahead;
      ahead = 0;
    };
    if (ahead != 0 && (crossings_.runs.empty() || (ahead > 0) != (crossings_.runs[0].dir > 0)))
      owe(0);
    for (size_t r = 0; r < crossings_.runs.size(); ++r) {
      size_t first = size_t(crossings_.runs[r].first);
      size_t last = r + 1 < crossings_.runs.size() ? size_t(crossings_.runs[r + 1].first)
                                                   : crossings_.s.size();
      int dir = crossings_.runs[r].dir;
      while (ahead != 0 && first < last && (ahead > 0) == (dir > 0)) ++first, ahead -= dir;
      if (first == last) continue;
      law.at(crossings_.s.data() + first, int(last - first), extend(out, last - first, dir));
      count_ += dir * int64_t(last - first);
    }
    if (ahead != 0) owe(m.d);
  }
};

}  // namespace passo
