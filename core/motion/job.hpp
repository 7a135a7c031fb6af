// Runs a G-code program on one machine: text in, planned motion out. It stops at each event that
// the caller must handle, and continues from there.
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
  // The limits of a move outside of any program: the machine's limits; the reach of its actuators,
  // for a return to an earlier position; or none, while the position is unknown.
  enum class Within : uint8_t { limits, reach, anything };

  Job(const Machine& machine, std::vector<double> home, const LaserWords& laser, bool with_steps,
      double (*cpu_clock)());

  Motion motion;
  Interpreter interpreter;
  double cpu_parse = 0, cpu_plan = 0;
  // Moves that were left out because they cannot be reached, and the first one's error.
  Interpreter::Clamped left_out;

  const GcodeError& error() const { return error_; }

  // Reads and plans until the caller must act (see Status). `full`: the plan reaches `horizon`
  // (ticks), with unsettled moves counted at their minimum duration, or more than `most` messages
  // wait. With `to_boundary` it reads only the rest of the line that it is in.
  Status advance(double horizon, size_t most, bool to_boundary = false);

  // Where the plan ends, in machine mm; E of the tool in use.
  std::array<double, kAxes> position() const { return motion.position(interpreter.extruder()); }

  // Drops the unread text of the selected source; its next line has this number.
  void restart(uint32_t first_line);
  // After an error or a stop: drops the rest of the line. The program continues from the end of
  // the plan.
  void abandon();
  // Brakes from `ticks` on and drops the moves that follow. `program`: of a program, whose
  // retraction ends too. Returns the clock of the cut.
  double stop_from(double ticks, bool program);

  // After motion.hold_from: other moves may come before the program continues. With `hand_over`
  // the rest of the macro that asked for the pause is among them.
  void suspend(bool hand_over = false);
  void resume();
  void forget_suspended() {
    motion.forget_suspended();
    suspended_.reset();
  }
  // M218, for lines that are read from now on, and for the suspended program.
  void set_tool_offset(size_t tool, int axis, double mm);

  // See Motion::set_height_map. The program's Z changes with that of the plan; its offsets stay.
  // The heights are those at the place of the tool in use: of its nozzle, not of the head.
  void set_height_map(std::shared_ptr<const HeightMap> map);
  // At standstill, after a change of the tool or of its offset: the heights are those at its place.
  // No motor moves; the next move goes to the Z that the program means.
  void follow_tool();
  // Whether that changes anything.
  bool bed_is_apart() const { return bed_ && tool_offset() != map_offset_; }

  // A straight move in machine coordinates, outside of any program. If it is too long, too slow or
  // not `within`, returns false, changes nothing and sets error().
  bool move_to(const double* target, double feed_mm_s, Within within);

  // Babystep: shifts everything from `ticks` on by `mm` along slot j (X, Y or Z), see
  // Motion::shift_from; the program's coordinates stay. Returns the clock of the cut. Returns
  // nothing and sets error() if an end would be out of range, or the axis is not homed.
  std::optional<double> shift_from(double ticks, int j, double mm);
  // The same, from the end of the moves that are read.
  bool shift(int j, double mm);
  // Babysteps of `mm` along slot j are part of the height map or of the axis' zero from now on, and
  // the end of the plan has changed with that. Coordinates of the program stay, and its suspended
  // moves end where they did. Only at standstill.
  void absorb_shift(int j, double mm);

  // Changes the flow of an extruder (M221, a factor) from `ticks` on, in planned, held and
  // suspended moves and in those still to be read; the program's E stays. Returns the clock of the
  // cut.
  double scale_flow_from(double ticks, size_t extruder, double flow);

  // Takes over a program's state from another job of the same machine, which has read the program
  // up to the machine's position.
  void adopt(Job& other);

  // After homing: the planner takes its position from the program.
  void settle_position();

 private:
  double (*cpu_clock_)();
  std::optional<Interpreter> suspended_;
  std::shared_ptr<const HeightMap> bed_;  // as it was given
  std::array<double, 2> map_offset_{};    // of the tool for which the plan has it
  std::vector<MoveRequest> batch_;
  Reach reach_;
  ReadEnd read_end_;
  bool may_be_slow_ = false;  // the last move that is read
  GcodeError error_;

  std::array<double, 2> tool_offset() const;
  void use_bed();

  // After a stop: the tool in use is the one of the move that stopped, not of the last line read.
  void use_stopped();

  double now() const { return cpu_clock_ ? cpu_clock_() : 0; }

  // Checks the last move of the batch. False: it breaks a limit; then it leaves the batch and
  // error() is set. With `clamp` it leaves the batch, and the result is true.
  bool admit(MoveRequest& m);
  // A move is left out: the next move does not print its filament.
  void leave_out(const MoveRequest& m);
  // If the move is too slow, returns false, changes nothing and sets error().
  bool push(const MoveRequest& m);

  bool may_shift(double ticks, int j, double mm);
};

}  // namespace passo
