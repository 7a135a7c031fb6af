// The load limits of all boards that drive motors, as limits of moves.
#pragma once
#include <algorithm>
#include <vector>

#include "plan/board_budget.hpp"

namespace passo {

// Each board bounds a move by the load of its own motors. Their commands ahead are kept in a move
// as one figure: the highest of all boards, as a fraction of its burst, times the burst of the
// first board that bounds commands.
class MoveBudget {
 public:
  explicit MoveBudget(const Machine& machine) {
    double unit = 0;
    for (size_t i = 0; i < machine.budgets.size(); ++i) {
      const Budget& budget = machine.budgets[i];
      boards_.push_back({BoardBudget(machine, uint8_t(i)), 0});
      if (budget.command_rate == kInfinity) continue;
      if (unit == 0) unit = budget.burst;
      boards_.back().scale = budget.burst > 0 && unit > 0 ? unit / budget.burst : 1;
    }
  }

  // The machine has another geometry of the same kind.
  void use_geometry() {
    for (Board& b : boards_) b.load.use_geometry();
  }

  bool bounds_anything() const {
    return std::any_of(boards_.begin(), boards_.end(),
                       [](const Board& b) { return b.load.bounds_anything(); });
  }

  // The next move begins with speed² `start2`, not where the last one ended.
  void restart(double start2) {
    for (Board& b : boards_) b.load.restart(start2);
  }

  // `ahead` of a move: for any cut of the plan, the free space in the boards' move queues.
  void set_ahead(double ahead) {
    for (Board& b : boards_) b.load.set_ahead(b.scale > 0 ? ahead / b.scale : 0);
  }

  // The machine is at standstill for this time.
  void rest(double seconds) {
    for (Board& b : boards_) b.load.rest(seconds);
  }

  // Tightens vn2 and widens the tolerance of a move; its start has at most speed² `start2`.
  void apply(Move& m, double start2) {
    m.ahead0 = ahead();
    if (m.kind == MoveKind::dwell) {
      for (Board& b : boards_) b.load.dwell(m.duration);
    } else {
      for (Board& b : boards_) b.load.bound_steps(m);
      for (Board& b : boards_) b.load.charge(m, start2);
    }
    m.ahead1 = ahead();
  }

 private:
  struct Board {
    BoardBudget load;
    double scale;  // 0: it bounds no commands
  };
  std::vector<Board> boards_;

  double ahead() const {
    double most = 0;
    for (const Board& b : boards_) most = std::max(most, b.load.ahead() * b.scale);
    return most;
  }
};

}  // namespace passo
