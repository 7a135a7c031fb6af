// Runs a G-code program on one machine: takes text and returns planned motion. It stops at each
// event that the caller must handle, and continues from there.
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "gcode/interpreter.hpp"
#include "motion/motion.hpp"
#include "motion/reach.hpp"
#include "motion/read_end.hpp"

namespace passo {

class Job {
 public:
  enum class Status : uint8_t { need_input, event, macro, error, full, end };
  // What limits a move outside of the program: the limits of the machine; only the reach of its
  // actuators, for the return to an earlier position; or nothing, while the position is unknown.
  enum class Within : uint8_t { limits, reach, anything };

  Job(const Machine& machine, std::vector<double> home, const LaserWords& laser, bool with_steps,
      double (*cpu_clock)());

  Motion motion;
  Interpreter interpreter;
  double cpu_parse = 0, cpu_plan = 0;
  // Number of moves that were left out because they are out of reach, and the error of the first
  // one.
  Interpreter::Clamped left_out;

  const GcodeError& error() const { return error_; }

  // Reads and plans until the caller must act (see Status). Returns `full` when the plan reaches
  // `horizon` (ticks), or when more than `most` messages wait. Unsettled moves count with their
  // minimum duration. With `to_boundary` it reads only the rest of the current line.
  Status advance(double horizon, size_t most, bool to_boundary = false);

  // The end of the plan, in machine mm; E is that of the tool in use.
  std::array<double, kAxes> position() const { return motion.position(interpreter.extruder()); }

  // Drops the unread text of the selected source. Its next line has the number `first_line`.
  void restart(uint32_t first_line);
  // After an error or a stop: drops the rest of the line. The program continues at the end of the
  // plan.
  void abandon();
  // Brakes from `ticks` on and drops the moves after that. `program`: also forgets the program's
  // retraction. Returns the clock of the cut.
  double stop_from(double ticks, bool program);

  // Suspends the program after motion.hold_from(), so that other moves can be made. With
  // `hand_over`, the rest of the macro that requested the pause is among them.
  void suspend(bool hand_over = false);
  void resume();
  void forget_suspended() {
    motion.forget_suspended();
    suspended_.reset();
  }
  // M218: applies to lines that are read from now on, and to the suspended program.
  void set_tool_offset(size_t tool, int axis, double mm);

  // See Motion::set_height_map. The program's Z follows the plan's Z; its offsets stay. The heights
  // are measured at the nozzle of the tool in use, not at the head.
  void set_height_map(std::shared_ptr<const HeightMap> map);
  // After a change of the tool or of its offset, at standstill: takes the heights at the new nozzle
  // position. No motor moves. The next move goes to the program's Z.
  void follow_tool();
  // Whether follow_tool() would change anything.
  bool bed_is_apart() const { return bed_ && tool_offset() != map_offset_; }

  // A straight move in machine coordinates, outside of any program. If it is too long, too slow or
  // not `within`, sets error(), changes nothing and returns false.
  bool move_to(const double* target, double feed_mm_s, Within within);

  // Babystep: shifts all motion from `ticks` on by `mm` along slot j (X, Y or Z), see
  // Motion::shift_from. The program's coordinates stay. Returns the clock of the cut. If the end of
  // a move would be out of range, or the axis is not homed, sets error() and returns nothing.
  std::optional<double> shift_from(double ticks, int j, double mm);
  // The same, after all moves that are read.
  bool shift(int j, double mm);
  // The height map or the zero of the axis now includes babysteps of `mm` along slot j, and the end
  // of the plan has changed accordingly. The coordinates of the program stay. Its suspended moves
  // end at the same positions. Call this only at standstill.
  void absorb_shift(int j, double mm);

  // Changes the flow factor of an extruder (M221) from `ticks` on, in planned, held, suspended and
  // unread moves. The program's E stays. Returns the clock of the cut.
  double scale_flow_from(double ticks, size_t extruder, double flow);
  // The same for the factor of the measured width, which M221 does not change.
  double scale_width_from(double ticks, size_t extruder, double width);

  // Copies the state of a program from another job of the same machine, which has read the program
  // up to the machine's position.
  void adopt(Job& other);

  // After homing: the planner continues from the program's position.
  void settle_position();

 private:
  double (*cpu_clock_)();
  std::optional<Interpreter> suspended_;
  // Applies a change of the flow to planned and read moves, also to those of a suspended job.
  double change_flow_from(double ticks, size_t extruder, const FlowChange& change);
  std::shared_ptr<const HeightMap> bed_;  // as set, without the offset of the tool
  std::array<double, 2> map_offset_{};    // offset of the tool that the plan's map is for
  std::vector<MoveRequest> batch_;
  Reach reach_;
  ReadEnd read_end_;
  bool may_be_slow_ = false;  // the last move that was read
  GcodeError error_;

  std::array<double, 2> tool_offset() const;
  void use_bed();

  // After a stop: selects the tool of the move that stopped. Lines after it may have selected
  // another one.
  void use_stopped();

  double now() const { return cpu_clock_ ? cpu_clock_() : 0; }

  // Checks the last move of the batch. If it breaks a limit, removes it, sets error() and returns
  // false. With `clamp`, removes it and returns true.
  // Where a line passes a place at which a motor would have to turn at once: the first of two lines
  // that lead round it; `m` becomes the second one.
  std::optional<MoveRequest> lead_round(MoveRequest& m) const;
  bool admit(MoveRequest& m);
  // Leaves out a move: the next move does not extrude its filament.
  void leave_out(const MoveRequest& m);
  // If the move is too slow, sets error(), changes nothing and returns false.
  bool push(const MoveRequest& m);

  bool may_shift(double ticks, int j, double mm);
};

}  // namespace passo
