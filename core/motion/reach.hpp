// Checks whether moves, arcs and offsets stay within reach of the actuators.
#pragma once
#include <cstdint>

#include "gcode/interpreter.hpp"
#include "plan/planner.hpp"

namespace passo {

class Reach {
 public:
  // All three must outlive this. The interpreter supplies the arc that is being read, the home
  // positions and the limits of the axes.
  Reach(const Machine& machine, const Planner& planner, Interpreter& interpreter)
      : machine_(machine), planner_(planner), interpreter_(interpreter) {}

  // The reason why the last check failed.
  const GcodeError& error() const { return error_; }

  // Whether a move of the program from `from`, and the whole arc that it begins or leads to, are
  // within reach, so that no arc is cut short. With `clamp`, only the move. A hop that makes the
  // move unreachable is removed from it and from the moves of its line that share it.
  bool admits(MoveRequest& m, const double* from) {
    const bool travels = m.kind != MoveKind::dwell && m.kind != MoveKind::extrude;
    return !travels || !checks() || reaches_arc(m, from) || reaches_without_hop(m, from);
  }

  // Whether a move of its own, outside of any program, is within reach.
  bool reaches(const MoveRequest& m, const double* from) {
    return !checks() || reaches_line(from, m.target, m.line);
  }
  // Whether the axes that move end within their limits.
  bool in_range(const MoveRequest& m);
  // Whether a planned position stays within limits and reach after its slot j was shifted to it.
  bool reaches_shifted(const double* position, int j);

 private:
  static constexpr double kCheckEvery = 2;  // mm along lines of nonlinear machines

  const Machine& machine_;
  const Planner& planner_;
  Interpreter& interpreter_;
  GcodeError error_;

  // False on a linear machine: there the limits of the axes are enough.
  bool checks() const { return planner_.constraints().checks_reach(); }
  bool reaches_arc(const MoveRequest& m, const double* from);
  bool reaches_without_hop(MoveRequest& m, const double* from);
  // Whether every actuator reaches the whole line between two positions without a jump.
  bool reaches_line(const double* from, const double* to, uint32_t line);
  // Finds the point of the jump, and sets error_. Returns false.
  bool stop_at_jump(const double* from, const double* to, uint32_t line);
  // An actuator may go up to its home, where its endstop is, wherever its limit is. If it is beyond
  // its limit at `from`, by a home offset, it may only go back.
  bool reaches_point(const double* p, uint32_t line, const double* from = nullptr);
};

}  // namespace passo
