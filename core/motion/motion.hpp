// One timeline that turns planned moves and timed records into messages for the boards, in the
// order of their clocks. Messages that are not sent yet can be revoked, and their moves planned
// again.
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
  // CPU seconds of each stage, measured by the clock of the constructor; 0 without a clock.
  struct Cpu {
    double steps = 0, compress = 0;
  };

  // `with_steps` false: plans without steps, for estimates.
  Motion(const Machine& machine, bool with_steps, double (*cpu_clock)() = nullptr);
  Motion(const Motion&) = delete;
  Motion& operator=(const Motion&) = delete;

  const Machine& machine() const { return machine_; }
  Planner& planner() { return planner_; }
  const PlanStatistics& plan() const { return plan_; }
  const Cpu& cpu() const { return cpu_; }
  // For the capacity of boards see step_stream.hpp.
  StepStream& stream() { return stream_; }
  const StepStream& stream() const { return stream_; }
  // A timed record. Records with targets from kMark on are not sent: the host reads them from
  // marks(), in the order of their clocks.
  static constexpr uint16_t kMark = 0x8000;
  static_assert(LaserLight::kNone < kMark);
  using Record = passo::Record;
  std::deque<Record>& marks() { return marks_; }
  const std::deque<Record>& marks() const { return marks_; }
  // Called with each settled move, before its steps are solved.
  std::function<void(const Move&)> on_move;
  // Delay of the motors after the plan, ticks.
  double delay() const { return machine_.filters.delay(machine_.clock_hz); }

  void push(const MoveRequest& request);

  // Appends pieces, which are planned already, after the moves pushed so far, and sets their
  // `start`. Each piece must start within kPieceJoint mm of the end of the piece before, and the
  // first one at the machine's position. Pieces are not planned again: a cut within them moves to
  // their end. If they do not join, or a motor cannot follow them, throws std::invalid_argument and
  // takes none.
  void add_pieces(std::vector<Piece> pieces);

  // A record for output `target`, due at the end of the moves pushed so far.
  void record(uint16_t target, uint32_t value);

  // Output `target` is the laser; `full` is its value for full power.
  void set_laser(uint16_t target, uint32_t full) { laser_.set(target, full); }
  // Power of the laser during moves that are pushed from now on, as a fraction of full power at
  // their feedrate. At a lower speed the power is reduced in proportion. 0: only records set the
  // power.
  void follow_speed(double share) { planner_.laser_share = share; }
  // A record for output `target` that is due at `ticks`, during the moves. It cannot be revoked:
  // later cuts must not be before it.
  void record_at(double ticks, uint16_t target, uint32_t value);

  // Settles all moves, with a stop at their end, and releases every message.
  void flush();

  // The machine stays at rest until `ticks`. Call this only after flush().
  void wait_until(double ticks) { planner_.wait_until(ticks); }

  // Sets the machine's position without motion. Call this only after flush(). `found`: a bit for
  // each slot whose position was found by the last motion, for example by an endstop. That motion
  // has closed the gap of the drive.
  void set_position(const double* position, size_t extruder, unsigned found = 0);
  // The end of the plan; slot kE is that of this extruder.
  std::array<double, kAxes> position(size_t extruder) const;
  // Changes the steps per mm or degree of motor i. Its maximum step rate stays. Call this only
  // after flush().
  void set_steps_per_unit(size_t i, double value);
  // Sets the bed correction; null: the bed is flat. No motor moves: the planned Z changes instead.
  // Call this only after flush().
  void set_height_map(std::shared_ptr<const HeightMap> map);
  // Sets another geometry of the same kind. No motor moves, and set_position() must follow. Call
  // this only after flush().
  void set_geometry(std::shared_ptr<const Geometry> geometry);
  // These motors make no steps during later moves; all others do. Call this only at rest. After
  // moves without a motor, set_position() must follow.
  void let_rest(const std::vector<size_t>& motors);
  // While `on`, the slots X, Y and Z are the positions of the first three actuators of a nonlinear
  // geometry, which move separately. Call this only at rest; set_position() must follow.
  void use_joints(bool on) {
    machine_.joints = on && planner_.constraints().actuators.size() >= 3;
    use_filters(filters_wanted_);
  }
  // Switches all motion filters on or off. Call this only at rest.
  void use_filters(bool on) {
    filters_wanted_ = on;
    machine_.filters.suspend(!on || machine_.joints);
    remember_nothing();
  }
  // Changes a setting of a motion filter (Filters::set). Positions stay. Call this only at rest.
  // Throws std::invalid_argument.
  void set_filter(std::string_view name, size_t index, const Numbers& numbers) {
    if (index >= std::max(machine_.extruders.size(), size_t(3)))
      throw std::invalid_argument("no such axis or extruder");
    const DriveGaps before = machine_.filters.gaps;
    machine_.filters.set(name, index, numbers);
    if (machine_.filters.gaps != before) stream_.use_gaps();
    remember_nothing();
  }
  void set_tool_offset(size_t tool, int j, double mm) { machine_.tools[tool].offset[j] = mm; }

  // See StepStream::use_commits. Call this only after flush().
  void use_commits(int64_t period, size_t most);
  // After a lost link, when the boards have stopped by themselves after commit `serial`. The moves
  // that did not take place are held, before those that are held already; release() continues them.
  // Outputs that were due during the stop change then. Returns the clock of the commit. If the
  // commit is no longer known, returns nothing and changes nothing.
  std::optional<double> recover_from(uint32_t serial);

  // Cuts motion at the first clock ≥ `ticks` that no command sent to a board covers, and plans the
  // rest again from the speed there, each move by its own limits. Returns the clock of the cut.
  double replan_from(double ticks);

  // Babystep: like replan_from(), and shifts everything after the cut by `mm` along slot j (X, Y or
  // Z). The shift starts after the braking distance, on which a board stops if it loses its link.
  // It is distributed over moves that have time for it; what is left becomes a move at the end. A
  // suspended plan continues from the shifted position. A held plan starts with a move to it.
  double shift_from(double ticks, int j, double mm, size_t extruder, size_t tool);
  // Shifts the suspended plan. The machine must return to the shifted position.
  void shift_suspended(int j, double mm);
  // Shifts everything after the moves so far, by an additional move.
  void push_shift(int j, double mm, size_t extruder, size_t tool);
  // Like replan_from(), with another flow of an extruder from the end of the braking distance on,
  // so that the machine can still stop at any time. The held plan changes too.
  double change_flow_from(double ticks, size_t extruder, FlowChange& change);
  // Changes the flow of an extruder in the suspended plan.
  void change_suspended_flow(size_t extruder, FlowChange& change);

  // Whether `allowed` is true for the shifted ends of all moves that shift_from() would shift.
  bool allows_shift(double ticks, int j, double mm,
                    const std::function<bool(const double*)>& allowed) const;

  // Ends the dwell that is in progress at `ticks`. Returns the clock of the cut; nothing without a
  // dwell.
  std::optional<double> skip_dwell_from(double ticks);

  // Later cuts are at `ticks` or after it. So older moves without steps can be dropped.
  void pass(double ticks) { passed_ = std::max(passed_, ticks); }

  // Feed hold: like replan_from(), but brakes to a stop on the path. The rest of the plan waits for
  // release(), before what is held already. The laser is off from the stop until release().
  // `stop_distance`: the actual braking distance, if other limits applied; 0 if unknown.
  double hold_from(double ticks, double stop_distance = 0);
  // Continues the held plan.
  void release();
  size_t held() const { return held_.moves.size(); }
  // The tool that hold_from() has stopped; nothing if no move is held.
  std::optional<size_t> stopped_tool() const;
  ProgramLines& lines() { return lines_; }
  // The planned position at `ticks`: X, Y, Z, the extruder of that move, and further axes. Returns
  // nothing if `ticks` is more than about a second ago.
  std::optional<std::array<double, kAxes>> position_at(double ticks) const;
  // Net filament of an extruder until `ticks`, mm, without pressure advance.
  double filament_at(double ticks, size_t extruder) const;
  // The tool of the move at `ticks`, else of the next move, if any.
  std::optional<size_t> tool_at(double ticks) const;
  // After hold_from(): suspends the held plan with its records, so that other moves can be made
  // from the stop position. resume() continues it; before that the machine must return to the stop
  // position.
  void suspend();
  bool suspended() const { return suspended_.has_value(); }
  const double* stop_position() const { return suspended_->stop; }
  void resume();
  // Drops the suspended plan.
  void forget_suspended() { suspended_.reset(); }
  // Drops the held plan and its records.
  void forget_held() { stand_before(std::exchange(held_, {})); }

 private:
  static constexpr double kSameDistance = 1e-9;  // rounding of distances, as a fraction
  static constexpr long kOutputsSeen = 32;     // number of last records that a new one may replace
  static constexpr double kKeptSeconds = 1.0;  // how long executed motion is kept
  Machine machine_;  // steps per unit and tool offsets may change at standstill
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
  uint32_t unattached_ = 0;  // number of last records_ that wait for the next move
  LaserLight laser_;
  uint32_t light_before_ = 0;  // power by records that are no longer kept
  double ticks_of_cut_ = 0;
  bool filters_wanted_ = true;
  bool in_pieces_ = false;  // the last motion was pieces: more may follow without a stop
  double pieces_end_ = 0;   // ticks
  double settles_at_ = 0;   // clock at which the filters come to rest; 0: at rest, or no filter

  static void change_flow(std::vector<Move>& moves, size_t extruder, FlowChange& change);
  void resume_plan(std::vector<Move>& moves, double speed2, double clock);
  // Continues planning after a cut. If moves are held, the plan ends with the stop.
  void continue_plan(std::vector<Move>& moves, double speed2);
  // Cuts the plan at `ticks`, calls `change` for the moves after the braking distance, and
  // continues.
  void change_from(double ticks, const std::function<void(std::vector<Move>&)>& change);
  // After a stop: sets each position to the start of the held plan, and that of each extruder to
  // the start of its own first held move.
  void stand_before(const HeldPlan& held);
  double now() const { return cpu_clock_ ? cpu_clock_() : 0; }
  void process(bool still);
  // Ticks from a clock of the plan until no filter depends on it.
  double memory() const { return machine_.filters.memory(machine_.clock_hz); }
  // After a change of filters: delays the next move until no filter depends on earlier moves.
  void remember_nothing() {
    if (memory() > 0) planner_.wait_until(planner_.clock() + memory());
  }
  // Places the records that wait for a move at the end of the plan.
  void place_at_end();

  // The power that the last record has set; 0 if moves set the power.
  uint32_t last_light() const;
  // After a cut between two moves: whether the move before the cut sets the laser.
  bool still_following() const;

  // The next n records are due at `ticks`. `without_move`: they belong to no move.
  void place(double ticks, uint32_t n, bool without_move);

  // Drops moves that ended before the last command sent. They cannot be planned again.
  void forget();

  // Drops limits of moves before `oldest`, which will not be planned again. Held and suspended
  // moves may be older.
  void forget_rules(const Move& oldest);

  void merge(bool all) { stream_.merge(planner_.clock(), all); }

  // Revokes steps, messages and moves from the first possible clock ≥ `ticks` on. Sets
  // ticks_of_cut_ to that clock and `rest` to the revoked moves. Returns the speed² at the cut.
  double cut(double ticks, std::vector<Move>& rest);
  // Assigns records after `at` to the moves of `rest` again. A record that came after a move is due
  // before the next one; a record that is late is due at once. Returns the number of records after
  // all moves.
  uint32_t take_back(int64_t at, std::vector<Move>& rest, bool under_way);
};

}  // namespace passo
