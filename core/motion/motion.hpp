// One timeline from planned moves and timed records to the boards' messages, in the order of their
// clocks. Messages that are not sent yet can be revoked and their moves planned again.
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "motion/laser.hpp"
#include "motion/line_tracker.hpp"
#include "motion/suspended_plan.hpp"
#include "plan/history.hpp"
#include "plan/planner.hpp"
#include "plan/statistics.hpp"
#include "steps/step_stream.hpp"

namespace passo {

class Motion {
 public:
  // CPU seconds by stage, measured by the given clock (none: not measured).
  struct Cpu {
    double steps = 0, compress = 0;
  };

  // `with_steps` false: plan only, for estimates.
  Motion(const Machine& machine, bool with_steps, double (*cpu_clock)() = nullptr);
  Motion(const Motion&) = delete;
  Motion& operator=(const Motion&) = delete;

  const Machine& machine() const { return machine_; }
  Planner& planner() { return planner_; }
  const PlanStatistics& plan() const { return plan_; }
  const Cpu& cpu() const { return cpu_; }
  // The capacity of boards: see step_stream.hpp.
  StepStream& stream() { return stream_; }
  const StepStream& stream() const { return stream_; }
  // A timed record. Records for targets from kMark on are not sent: marks() lists them for the
  // host, in the order of their clocks.
  static constexpr uint16_t kMark = 0x8000;
  static_assert(LaserLight::kNone < kMark);
  using Record = passo::Record;
  std::deque<Record>& marks() { return marks_; }
  const std::deque<Record>& marks() const { return marks_; }
  // Called with each settled move, before its steps are solved.
  std::function<void(const Move&)> on_move;
  // Ticks by which the motors follow the plan.
  double delay() const { return machine_.filters.delay(machine_.clock_hz); }

  void push(const MoveRequest& request);

  // Appends pieces, which are already planned, to the moves pushed so far, and sets their `start`.
  // Each piece begins where the one before it ends, to kPieceJoint mm, and the first one where the
  // machine is. Pieces are not planned again: a cut among them moves to the end of the last.
  // Throws std::invalid_argument, and takes none, if they do not join, or a motor cannot follow.
  void add_pieces(std::vector<Piece> pieces);

  // A record for output `target`, due at the end of the moves pushed so far.
  void record(uint16_t target, uint32_t value);

  // Output `target` is a laser, fully on at `full`.
  void set_laser(uint16_t target, uint32_t full) { laser_.set(target, full); }
  // The laser's fraction of full power on moves pushed from now on, at their feedrate; if a move is
  // slower, the power is reduced in proportion. 0: only records set the power.
  void follow_speed(double share) { planner_.laser_share = share; }
  // A record for output `target`, due at `ticks` during the moves. It cannot be revoked: no later
  // cut may be at an earlier clock.
  void record_at(double ticks, uint16_t target, uint32_t value);

  // Settles all moves, for a stop at the end, and releases every message.
  void flush();

  // The machine rests until `ticks`. Only after flush.
  void wait_until(double ticks) { planner_.wait_until(ticks); }

  // Sets where the machine is, without motion. Only after flush. `found`: a bit for each slot whose
  // position the last motion has found; this motion has taken up the gap of the drive.
  void set_position(const double* position, size_t extruder, unsigned found = 0);
  // Where the plan ends; E is this extruder's, if the machine has it.
  std::array<double, kAxes> position(size_t extruder) const;
  // Changes the steps of motor i for a mm or degree; its maximum step rate stays.
  // Only after flush.
  void set_steps_per_unit(size_t i, double value);
  // Bed correction from now on; null: the bed is flat. No motor moves: the Z of the plan changes to
  // that of the machine. Only after flush.
  void set_height_map(std::shared_ptr<const HeightMap> map);
  // Another geometry of the same kind from now on. No motor moves; set_position must follow. Only
  // after flush.
  void set_geometry(std::shared_ptr<const Geometry> geometry);
  // These motors make no step of later moves, all others do. Only at rest; set_position must follow
  // the moves of a motor that rests.
  void let_rest(const std::vector<size_t>& motors);
  // While `on`, X, Y and Z of all positions are the positions of the first three actuators of a
  // nonlinear geometry, and each moves by itself. Only at rest; set_position must follow.
  void use_joints(bool on) {
    machine_.joints = on && planner_.constraints().actuators.size() >= 3;
    use_filters(filters_wanted_);
  }
  // Motion is filtered from now on, or not. Only at rest.
  void use_filters(bool on) {
    filters_wanted_ = on;
    machine_.filters.suspend(!on || machine_.joints);
    remember_nothing();
  }
  // A setting of a motion filter from now on (Filters::set). Positions stay. Only at rest. Throws
  // std::invalid_argument.
  void set_filter(std::string_view name, size_t index, const Numbers& numbers) {
    if (index >= std::max(machine_.extruders.size(), size_t(3)))
      throw std::invalid_argument("no such axis or extruder");
    const DriveGaps before = machine_.filters.gaps;
    machine_.filters.set(name, index, numbers);
    if (machine_.filters.gaps != before) stream_.use_gaps();
    remember_nothing();
  }
  void set_tool_offset(size_t tool, int j, double mm) { machine_.tools[tool].offset[j] = mm; }

  // See StepStream::use_commits. Only after flush.
  void use_commits(int64_t period, size_t most);
  // After a lost link: the boards have braked to a stop after the commit `serial`. The moves that
  // did not take place are held, before those that are held already, and `release` continues them
  // at any later clock. Outputs that were due during the stop change then. Returns the clock of
  // the commit. If the commit is too old to be known, returns nothing and changes nothing.
  std::optional<double> recover_from(uint32_t serial);

  // Cuts every stepper at the first clock ≥ `ticks` that no command sent to a board covers, and
  // plans the rest again from the speed at that clock, each move by its own rules. Returns that
  // clock, the clock of the cut.
  double replan_from(double ticks);

  // Babystep: as replan_from, and shifts everything after the cut by `mm` along slot j (X, Y or Z).
  // The shift begins after the braking distance, on which a board that loses its link stops. It is
  // spread over the moves that have room for it; the rest is a move of its own at the end. A
  // suspended plan continues from the shifted position; a held plan begins with a move to there.
  double shift_from(double ticks, int j, double mm, size_t extruder, size_t tool);
  // Shifts the suspended plan; the machine must return to the shifted position.
  void shift_suspended(int j, double mm);
  // Shifts everything after the moves so far, by a move of its own.
  void push_shift(int j, double mm, size_t extruder, size_t tool);
  // As replan_from, with another flow of an extruder from the end of the braking distance on, so
  // that the machine can still stop at any time. The held plan changes too.
  double change_flow_from(double ticks, size_t extruder, FlowChange& change);
  // The same for the suspended plan.
  void change_suspended_flow(size_t extruder, FlowChange& change);

  // Whether `allowed` holds for the shifted ends of all moves that shift_from would shift.
  bool allows_shift(double ticks, int j, double mm,
                    const std::function<bool(const double*)>& allowed) const;

  // Ends the dwell that is under way at `ticks`, if there is one; returns the clock of the cut.
  std::optional<double> skip_dwell_from(double ticks);

  // No cut will be before `ticks`: moves without steps before it need not be kept.
  void pass(double ticks) { passed_ = std::max(passed_, ticks); }

  // Feed hold: as replan_from, but brakes to a stop on the path. The rest of the plan waits for
  // `release`, before what is held already. A lit laser goes off at the stop, and on again at
  // `release`. `stop_distance`: the actual braking distance, if limits differed; 0 if unknown.
  double hold_from(double ticks, double stop_distance = 0);
  // Continues the held plan.
  void release();
  size_t held() const { return held_.moves.size(); }
  // The tool that hold_from has stopped; nothing if no move is held.
  std::optional<size_t> stopped_tool() const;
  ProgramLines& lines() { return lines_; }
  // The planned position at `ticks`: X, Y, Z, the extruder of that move and further axes. Nothing
  // if `ticks` is more than about a second in the past.
  std::optional<std::array<double, kAxes>> position_at(double ticks) const;
  // Net filament that an extruder has pushed until `ticks`, mm, without its pressure advance.
  double filament_at(double ticks, size_t extruder) const;
  // The tool of the move at `ticks`, or else of the next one; nothing without one.
  std::optional<size_t> tool_at(double ticks) const;
  // After hold_from: suspends the held plan with its records, so that other moves may come first,
  // from where the machine rests. `resume` continues it; the machine must be back there.
  void suspend();
  bool suspended() const { return suspended_.has_value(); }
  const double* stop_position() const { return suspended_->stop; }
  void resume();
  // Drops the suspended plan.
  void forget_suspended() { suspended_.reset(); }
  // Drops the held plan and its records.
  void forget_held() { stand_before(std::exchange(held_, {})); }

 private:
  static constexpr double kSameDistance = 1e-9;  // fraction by which rounding changes distances
  static constexpr long kOutputsSeen = 32;       // last records that a new one may replace
  static constexpr double kKeptSeconds = 1.0;    // how long executed motion is kept
  Machine machine_;  // its steps per unit and tool offsets may change at standstill
  Planner planner_;
  bool with_steps_;
  double (*cpu_clock_)();
  Cpu cpu_;
  PlanStatistics plan_;
  StepStream stream_;
  std::deque<Record> records_, placed_, marks_;
  History history_;
  double passed_ = 0;
  HeldPlan held_;
  ProgramLines lines_;
  struct Suspended {
    HeldPlan held;
    double stop[kAxes], end[kAxes];
    std::vector<double> extruders;
    std::vector<int64_t> counts;  // steps of each motor at the stop
  };
  std::optional<Suspended> suspended_;
  uint32_t unattached_ = 0;  // last records_ that wait for a move to follow
  LaserLight laser_;
  uint32_t light_before_ = 0;  // of records forgotten
  double ticks_of_cut_ = 0;
  bool filters_wanted_ = true;
  bool in_pieces_ = false;  // the last motion was pieces: more may follow without a stop
  double pieces_end_ = 0;   // ticks
  double settles_at_ = 0;   // clock at which filters let the machine rest; 0: at rest, or no filter

  static void change_flow(std::vector<Move>& moves, size_t extruder, FlowChange& change);
  void resume_plan(std::vector<Move>& moves, double speed2, double clock);
  // After a cut. While moves are held, the plan ends with the stop.
  void continue_plan(std::vector<Move>& moves, double speed2);
  // Cuts the plan at `ticks`, lets `change` change what follows the braking distance, and
  // continues.
  void change_from(double ticks, const std::function<void(std::vector<Move>&)>& change);
  // After a stop: the next move starts where the held plan would have continued, for each extruder
  // where its own moves would.
  void stand_before(const HeldPlan& held);
  double now() const { return cpu_clock_ ? cpu_clock_() : 0; }
  void process(bool still);
  // Ticks from a clock of the plan until no filter remembers it.
  double memory() const { return machine_.filters.memory(machine_.clock_hz); }
  // After a change of filters: the next move begins when they remember no earlier one.
  void remember_nothing() {
    if (memory() > 0) planner_.wait_until(planner_.clock() + memory());
  }
  // The records that wait for a move are due where the plan ends.
  void place_at_end();

  // The power that the last record has set; 0 where the power follows the speed.
  uint32_t last_light() const;
  // After a cut between two moves: whether the move before it sets the laser.
  bool still_following() const;

  // The next n records are due at `ticks`. `alone`: no move brings them.
  void place(double ticks, uint32_t n, bool alone);

  // Drops moves that ended before the last command sent: they cannot be planned again.
  void forget();

  // No move before this one will be planned again. HeldPlan and suspended moves may be older.
  void forget_rules(const Move& oldest);

  void merge(bool all) { stream_.merge(planner_.clock(), all); }

  // Revokes steps, messages and moves from a clock ≥ `ticks` on. Sets ticks_of_cut_ to that clock
  // and `rest` to the revoked moves. Returns the speed² at the cut.
  double cut(double ticks, std::vector<Move>& rest);
  // Gives records later than `at` back to the moves of `rest` that brought them. Records that came
  // after a move come before the next one, and late ones at once. Returns the number of records
  // after all moves.
  uint32_t take_back(int64_t at, std::vector<Move>& rest, bool under_way);
};

}  // namespace passo
