// Types that the stages of the core share. Positions are mm (degrees for rotary actuators), times
// are seconds, clocks are ticks of the primary board counted from the start of the job.
#pragma once
#include <cstdint>
#include <limits>

namespace passo {

// A move carries X, Y, Z, the position of the *active* extruder, and up to four further linear
// axes. An extruder that is not active never moves, so any number of extruders fits.
inline constexpr int kAxes = 8;
inline constexpr int kX = 0, kY = 1, kZ = 2, kE = 3, kExtra = 4;

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();
inline constexpr double kMaxMoveS = 1e6;  // s, dwells too

enum class MoveKind : uint8_t {
  travel,
  print,
  extrude,
  dwell
};  // extrude: E alone (retract, prime)

// The kind of a move, for reports and statistics.
struct MoveOrigin {
  uint32_t line;       // 1-based line of the source
  uint32_t main_line;  // the line of the call, for a line of a sub-program; else the same
  uint16_t layer;      // slicer's layer, 0 before the first
  uint16_t feature;    // index in the interpreter's table of feature names, 0 = none
  uint16_t extruder;   // active extruder
  uint16_t tool;       // number of the tool in use; tools may share an extruder
};

// The interpreter's request to the planner for each G0, G1, chord of an arc, retraction or dwell.
// The start of a move is the end of the one before it.
struct MoveRequest : MoveOrigin {
  double target[kAxes];  // absolute machine position, mm
  double feed_mm_s;      // F; infinity when none was ever given
  double duration_s;     // APrinter's T: the minimum duration; of a dwell, the duration; else 0
  double energy_ws;      // laser energy of this move, W·s
  double beam;           // a laser's fraction of full power at 1 mm/s; of a dwell: the fraction
                         // itself; 0: off
  double fastest_mm_s;   // independent of M220; 0: no such limit
  double flow;           // flow factor that has scaled E (M221); 0: the filament is not a program's
  double owed_mm;        // filament that is retracted at the start of the move
  double hop_mm;         // Z hop of a retraction, contained in the target's Z
  double radius_mm;      // arc radius; infinity on straight moves
  MoveKind kind;
  uint8_t moved;     // bit per axis: the command had its letter
  uint8_t arc_axis;  // slot perpendicular to the arc's plane
  bool arc_inner;    // joins the chord before it on the same arc: no junction limit
  bool rapid;        // G0
  bool unscaled;     // not of a program: M220 does not apply
};

// One command for the board. Commands of a board are queued in the order of `clock`.
// `tail` and `commit`: see commits.hpp.
enum class MessageKind : uint8_t { queue_step, set_dir, reset_clock, pin, tail, commit };
struct Message {
  int64_t clock;      // tick at which the board starts it (queue_step: the last step before it)
  int64_t end_clock;  // tick at which its move slot is free again (equals clock if it takes none)
  // queue_step, tail: ticks to its first step (tail without steps: the clock to count from); pin:
  // value; commit: serial number
  uint32_t interval;
  uint16_t count;   // queue_step: number of steps
  int16_t add;      // queue_step: change of the interval after each step
  uint16_t target;  // index of the stepper, or of the output pin
  MessageKind kind;
  uint8_t dir;  // set_dir, queue_step, tail: 1 forward; commit: 1 if the machine is at standstill
                // after it

  // Clock of the step before its first one.
  int64_t start() const { return end_clock - span(count); }
  // How many of its steps are due until a clock.
  int64_t steps_until(int64_t clock) const {
    int64_t n = count;
    while (n > 0 && start() + span(n) > clock) --n;
    return n;
  }
  // Duration of the first n steps in ticks.
  int64_t span(int64_t n) const { return int64_t(interval) * n + int64_t(add) * (n * (n - 1) / 2); }
};
static_assert(sizeof(Message) == 32);

}  // namespace passo
