// Sums over a plan: times by kind, limit, layer and feature; distances; filament.
#pragma once
#include <cstdint>
#include <vector>

#include "machine/machine.hpp"
#include "plan/move.hpp"
#include "plan/pieces.hpp"

namespace passo {

struct PlanStatistics {
  int64_t moves = 0;
  double move_s = 0, dwell_s = 0, travel_mm = 0, print_mm = 0;
  std::vector<double> filament_mm;                  // net, by extruder
  std::vector<double> limit_s, layer_s, feature_s;  // by LimitId, layer, feature
  // The highest load of the boards' budgets: line, fraction of the budget (at most 1: within it),
  // and index of the budget.
  struct Load {
    uint32_t line = 0;
    double share = 0;
    uint8_t budget = 0;
  };
  Load most_steps, most_commands;
  // Peaks as the budgets calculate them: of each budget, steps/s of a move in cruise and commands/s
  // over kWindow or more; commands ahead of the boards' rates.
  struct Peak {
    uint32_t line = 0;
    double most = 0;
    void see(uint32_t at, double value) {
      if (value > most) line = at, most = value;
    }
  };
  static constexpr double kWindow = 0.15;  // s that a board has ahead
  Peak steps_s[kBudgets], commands_s[kBudgets], ahead;
  double widened_s = 0, widest_ticks = 0;  // time with a wider tolerance, and the widest

  // sign -1 subtracts the moves that a replan revokes.
  void add(const Move& m, double hz, int sign);

  void add(const Piece& p);

 private:
  double window_s_ = 0, window_commands_[kBudgets] = {};
  uint32_t window_line_ = 0;

  void pass(const Move& m, double seconds);
  static double& grow(std::vector<double>& v, size_t i) {
    if (i >= v.size()) v.resize(i + 1, 0.0);
    return v[i];
  }
};

}  // namespace passo
