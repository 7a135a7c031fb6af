#include "steps/step_solver.hpp"

#include <algorithm>
#include <cstdint>

#include "steps/time_law.hpp"

namespace passo {

StepSolver::StepSolver(const Machine& machine, const StepperSpec& spec)
    : machine_(machine), spec_(spec), hz_(machine.clock_hz), pieces_(machine, spec) {
  use_geometry();
}

void StepSolver::use_geometry() {
  for (double& c : c_) c = 0;
  linear_ = true;
  if (spec_.drive == Drive::extruder) {
    axis_ = kE;
  } else if (spec_.drive == Drive::axis) {
    axis_ = slot_of_axis(spec_.index);
  } else {
    linear_ = machine_.geometry->linear(spec_.index, c_);
  }
}

void StepSolver::solve(const Move& m, Steps& out) {
  if (spec_.drive == Drive::extruder && m.extruder != spec_.index) return;
  if (m.kind == MoveKind::dwell) return;
  out.set_tolerance(m.tolerance);
  // Any distance counts, even if filament determines the path measure.
  bool travels = m.p0[kX] != m.p1[kX] || m.p0[kY] != m.p1[kY] || m.p0[kZ] != m.p1[kZ];
  if (travels && pieces_.raised())
    solve_raised(m, out);
  else if (linear_ || machine_.joints)
    solve_linear(m, out);
  else if (travels)
    solve_path(m, out);
}

void StepSolver::solve(const Piece& p, Steps& out) {
  out.set_tolerance(0);
  count_ = lead_ + pieces_.solve(p, count_ - lead_, count_at(p.end) - lead_, true, out);
}

double StepSolver::position(const double* p) const {
  if (machine_.joints && spec_.drive == Drive::actuator)
    return spec_.index < 3 ? p[spec_.index] * spec_.steps_per_unit : double(count_ - lead_);
  if (axis_ >= 0) return p[axis_] * spec_.steps_per_unit;
  double at[3] = {p[0], p[1], pieces_.raised() ? machine_.raised(p) : p[2]};
  if (linear_) return (c_[0] * at[0] + c_[1] * at[1] + c_[2] * at[2]) * spec_.steps_per_unit;
  return nearest_turn(*machine_.geometry, spec_.index, spec_.steps_per_unit,
                      machine_.geometry->inverse(spec_.index, at) * spec_.steps_per_unit,
                      double(count_ - lead_));
}

inline void StepSolver::solve_linear(const Move& m, Steps& out) {
  double from = position(m.p0) + double(lead_), to = position(m.p1) + double(lead_);
  int64_t target = int64_t(std::floor(to + 0.5)), n = target - count_;
  if (n == 0) return;
  double dir = n > 0 ? 1 : -1;
  n = n > 0 ? n : -n;
  double per_step = from == to ? 0 : m.d / std::fabs(to - from);
  double s0 = (double(count_) + 0.5 * dir - from) * dir * per_step;
  double* t = out.extend(size_t(n), int(dir));
  TimeLaw(m, hz_).even(s0, std::max(per_step, 1e-12), int(n), t);
  // After a cut: steps that were due before it come at once.
  for (int64_t k = 0; k < n && s0 + per_step * double(k) < 0; ++k) t[k] = m.start;
  count_ = target;
}

void StepSolver::solve_raised(const Move& m, Steps& out) {
  int64_t target = count_at(m.p1);
  if (target == count_ && pieces_.rests(m.p0, m.p1, count_ - lead_)) return;
  double d_dec = m.d - m.d_acc - m.d_cru, begin[] = {0, m.d_acc, m.d_acc + m.d_cru};
  double ticks[] = {m.t_acc, m.t_cru, m.t_dec}, distance[] = {m.d_acc, m.d_cru, d_dec};
  double speed[] = {m.v0, m.vc, m.vc}, accel[] = {m.a, 0, -m.b}, start = m.start;
  int last = m.t_dec > 0 ? 2 : m.t_cru > 0 ? 1 : 0;
  for (int i = 0; i <= last; start += ticks[i++]) {
    if (!(ticks[i] > 0 && distance[i] > 0) && i < last) continue;
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
    count_ = lead_ + pieces_.solve(p, count_ - lead_, target - lead_, i == last, out);
  }
}

void StepSolver::solve_path(const Move& m, Steps& out) {
  Path path{{m.p0[0], m.p0[1], m.p0[2]}, {m.p1[0], m.p1[1], m.p1[2]}, m.d};
  crossings_.near = double(count_);
  machine_.geometry->crossings(spec_.index, path, spec_.steps_per_unit, crossings_);
  TimeLaw law(m, hz_);
  // After a cut: steps that were executed early are skipped, and steps that are missing are added.
  int64_t ahead = count_ - crossings_.k0;
  auto owe = [&](double s) {
    size_t n = size_t(std::abs(ahead));
    owed_.assign(n + 3, s);
    law.at(owed_.data(), int(n), out.extend(n, ahead > 0 ? -1 : 1));
    count_ -= ahead;
    ahead = 0;
  };
  if (ahead != 0 && (crossings_.runs.empty() || (ahead > 0) != (crossings_.runs[0].dir > 0)))
    owe(0);
  for (size_t r = 0; r < crossings_.runs.size(); ++r) {
    size_t first = size_t(crossings_.runs[r].first);
    size_t last =
        r + 1 < crossings_.runs.size() ? size_t(crossings_.runs[r + 1].first) : crossings_.s.size();
    int dir = crossings_.runs[r].dir;
    while (ahead != 0 && first < last && (ahead > 0) == (dir > 0)) ++first, ahead -= dir;
    if (first == last) continue;
    law.at(crossings_.s.data() + first, int(last - first), out.extend(last - first, dir));
    count_ += dir * int64_t(last - first);
  }
  if (ahead != 0) owe(m.d);
}

}  // namespace passo
