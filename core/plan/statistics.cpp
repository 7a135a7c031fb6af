#include "plan/statistics.hpp"

#include <algorithm>
#include <cmath>

namespace passo {

void PlanStatistics::add(const Move& m, double hz, int sign) {
  double per_tick = sign / hz, seconds = m.ticks() * per_tick;
  grow(layer_s, m.layer) += seconds;
  grow(feature_s, m.feature) += seconds;
  if (sign > 0) pass(m, seconds);
  if (m.kind == MoveKind::dwell) {
    dwell_s += seconds;
    return;
  }
  if (!m.inner) moves += sign;
  move_s += seconds;
  if (m.step_load > most_steps.share) most_steps = {m.line, m.step_load, m.step_budget};
  if (m.command_load > most_commands.share)
    most_commands = {m.line, m.command_load, m.command_budget};
  if (m.tolerance > 0) {
    widened_s += seconds;
    widest_ticks = std::max(widest_ticks, m.tolerance);
  }
  bool slow = m.vc * m.vc < m.vn2 * (1 - 1e-9);
  const LimitId junction = m.advance_binds ? kAdvanceJunction : kJunction;
  grow(limit_s, slow ? junction : m.speed_limit) += m.t_cru * per_tick;
  grow(limit_s, m.accel_limit) += (m.t_acc + m.t_dec) * per_tick;
  if (m.cartesian) {
    double dx = m.p1[0] - m.p0[0], dy = m.p1[1] - m.p0[1], dz = m.p1[2] - m.p0[2];
    (m.kind == MoveKind::print ? print_mm : travel_mm) +=
        sign * std::sqrt(dx * dx + dy * dy + dz * dz);
  }
  if (m.extruder < filament_mm.size()) filament_mm[m.extruder] += sign * (m.p1[kE] - m.p0[kE]);
}

void PlanStatistics::add(const Piece& p) {
  move_s += p.seconds;
  if (p.extruder < filament_mm.size()) filament_mm[p.extruder] += p.end[kE] - p.c[kE][0];
}

void PlanStatistics::pass(const Move& m, double seconds) {
  if (m.kind != MoveKind::dwell) {
    const double per_step = m.vc / m.d;
    ahead.see(m.line, m.ahead1);
    if (window_s_ == 0) window_line_ = m.line;
    for (size_t i = 0; i < kBudgets; ++i) {
      steps_s[i].see(m.line, double(m.steps[i]) * per_step);
      window_commands_[i] += double(m.commands[i]);
    }
  }
  window_s_ += seconds;
  if (window_s_ < kWindow) return;
  for (size_t i = 0; i < kBudgets; ++i) {
    commands_s[i].see(window_line_, window_commands_[i] / window_s_);
    window_commands_[i] = 0;
  }
  window_s_ = 0;
}

}  // namespace passo
