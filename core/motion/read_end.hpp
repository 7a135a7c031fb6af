// The end of the moves that are read, where the next move starts. The length and the minimum
// duration of that move follow from it, before the move is planned.
#pragma once
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "gcode/parse_result.hpp"
#include "plan/planner.hpp"

namespace passo {

class ReadEnd {
 public:
  // Both must outlive this.
  ReadEnd(const Machine& machine, const Planner& planner)
      : machine_(machine), planner_(planner), extruders_(machine.extruders.size()) {}

  // The next moves that are read start at the end of the plan.
  void take_plan_end() {
    std::copy_n(planner_.position(), kAxes, position_);
    for (size_t i = 0; i < extruders_.size(); ++i) extruders_[i] = planner_.extruder_position(i);
    const Constraints& constraints = planner_.constraints();
    slowest_mm_s_ = planner_.rules().now().limits.speed;
    for (const Row& row : constraints.rows) slowest_mm_s_ = std::min(slowest_mm_s_, row.speed);
    for (const Row& row : constraints.extruders) slowest_mm_s_ = std::min(slowest_mm_s_, row.speed);
  }

  // The next move starts at the end of `m`.
  void pass(const MoveRequest& m) {
    std::copy_n(m.target, kAxes, position_);
    if (!extruders_.empty()) extruders_[m.extruder] = m.target[kE];
  }

  const double* position() const { return position_; }

  // A dwell or a move of filament alone starts here after all, not where the program is. Then a
  // dwell moves nothing, and filament moves neither X, Y nor Z.
  void start_here(MoveRequest& m) const {
    if (m.kind == MoveKind::extrude) std::copy_n(position_, 3, m.target);
    if (m.kind != MoveKind::dwell) return;
    std::copy_n(position_, kAxes, m.target);
    if (!extruders_.empty()) m.target[kE] = extruders_[m.extruder];
  }

  // Filament that the extruder pushes, mm; 0 without an extruder.
  double filament_mm(const MoveRequest& m) const {
    return extruders_.empty() ? 0 : m.target[kE] - extruders_[m.extruder];
  }

  // The minimum duration of a move, s, roughly.
  double least_s(const MoveRequest& m) const {
    double mm_s = 0;
    for (const Row& row : planner_.constraints().rows) mm_s += row.speed;
    return std::max(m.duration_s, distance_mm(m) / std::min(m.feed_mm_s, mm_s));
  }

  // Whether the planner may find that the move takes longer than kMaxMoveS.
  bool may_be_slow(const MoveRequest& m) const {
    const double mm = distance_mm(m);
    return m.duration_s > kQuickS || mm > kQuickS * m.feed_mm_s || mm > kQuickS * slowest_mm_s_;
  }

  // Whether the move pushes more filament than kMaxFilamentMm; if so, sets `error`.
  bool too_long(const MoveRequest& m, GcodeError& error) const {
    if (m.kind == MoveKind::dwell) return false;
    auto beyond = [&](double mm, const std::string& name) {
      if (std::fabs(mm) <= kMaxFilamentMm) return false;
      error = {m.line, Fault::too_long, name, mm, kMaxFilamentMm, {0, 0, 0}};
      return true;
    };
    for (size_t a = 3; a < machine_.axes.size(); ++a) {
      const int j = slot_of_axis(int(a));
      const Axis& axis = machine_.axes[a];
      if (axis.filament && beyond(m.target[j] - position_[j], axis.name)) return true;
    }
    return !extruders_.empty() && beyond(filament_mm(m), machine_.extruders[m.extruder].name);
  }

 private:
  // No axis limits filament, and all steps of a move are calculated at once.
  static constexpr double kMaxFilamentMm = 10'000;
  static constexpr double kQuickS = 100;  // a move that takes less at full speed is not too slow

  const Machine& machine_;
  const Planner& planner_;
  double position_[kAxes] = {};
  std::vector<double> extruders_;
  double slowest_mm_s_ = kInfinity;  // of axes and extruders

  double distance_mm(const MoveRequest& m) const {
    double mm = 0;
    for (int j = 0; j < kAxes; ++j)
      if (j != kE) mm += std::fabs(m.target[j] - position_[j]);
    return mm + std::fabs(filament_mm(m));
  }
};

}  // namespace passo
