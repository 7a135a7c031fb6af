// One timeline from planned moves and timed records to the board's messages, in the order of their
// clocks, with the way back: what is not yet sent can be planned anew.
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
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
  // What boards take: see step_stream.hpp.
  StepStream& stream() { return stream_; }
  const StepStream& stream() const { return stream_; }
  // A timed record. Targets from kMark on are the host's own: they come out of marks(), in the
  // order of their clocks, and are not sent.
  static constexpr uint16_t kMark = 0x8000;
  static_assert(LaserLight::kNone < kMark);
  using Record = passo::Record;
  std::deque<Record>& marks() { return marks_; }
  const std::deque<Record>& marks() const { return marks_; }
  // Called with each settled move, before its steps are solved.
  std::function<void(const Move&)> on_move;

  void push(const MoveRequest& request);

  // Takes pieces, already planned, from where and when the moves pushed so far have ended; `start`s
  // are set here. Each begins where the one before it ends, to kPieceJoint mm, and the first one
  // where the machine is. They are never planned anew: a cut among them falls behind the last.
  // Throws std::invalid_argument, and takes none, if they do not join, or a motor cannot follow.
  void add_pieces(std::vector<Piece> pieces);

  // A record for output `target`, due when the moves pushed so far are done.
  void record(uint16_t target, uint32_t value);

  // Output `target` is a laser, fully on at `full`.
  void set_laser(uint16_t target, uint32_t full) { laser_.set(target, full); }
  // The laser's share of full power, on moves pushed from now on, where they go as fast as they
  // were told to; elsewhere less, as they are slower. 0: records alone set it.
  void follow_speed(double share) { planner_.laser_share = share; }
  // A record for output `target`, due at `ticks` in the midst of the moves. It cannot be revoked:
  // no cut may be asked for at an earlier clock any more.
  void record_at(double ticks, uint16_t target, uint32_t value);

  // Settles all, for a stop at the end, and hands out every message.
  void flush();

  // The machine stands until `ticks`. Only after flush.
  void wait_until(double ticks) { planner_.wait_until(ticks); }

  // Sets where the machine is, without motion. Only after flush.
  void set_position(const double* position, size_t extruder);
  // Where the plan ends; E is this extruder's, if the machine has it.
  std::array<double, kAxes> position(size_t extruder) const;
  // Changes how many steps motor i makes for a mm or degree; its highest rate of steps still holds.
  // Only after flush.
  void set_steps_per_unit(size_t i, double value);
  // From now on the bed adds these heights to Z (none: it is flat). No motor moves: what changes is
  // the Z of the plan, which is then where the machine is. Only after flush.
  void set_height_map(std::shared_ptr<const HeightMap> map);
  // While `on`, X, Y and Z of all positions are those of the first three actuators of a nonlinear
  // geometry, each of which moves by itself. Only while the machine stands; where it is must be set
  // after either change.
  void use_joints(bool on) { machine_.joints = on && planner_.constraints().actuators.size() >= 3; }
  void set_tool_offset(size_t tool, int j, double mm) { machine_.tools[tool].offset[j] = mm; }

  // See StepStream::use_commits. Only after flush.
  void use_commits(int64_t period, size_t most);
  // The boards were left alone: they have come to a stop behind the commit `serial`, as it told
  // them to.
  // Plans anew from there; what was to follow is held, with what is held already, and `release`
  // goes on with it at any later clock; expected_net() tells where each motor must be by now.
  // Outputs that were to change on the way change when it goes on. Returns the clock of the commit;
  // nothing, and nothing is changed, if that is not known any more.
  std::optional<double> recover_from(uint32_t serial);

  // Cuts every stepper at the first clock ≥ `ticks` that is not bound by a command already taken
  // from messages(), and goes on from the speed that the machine has there, each move by its rules.
  // Returns that clock.
  double replan_from(double ticks);

  // As replan_from, and all that is still to come lies `mm` further along slot j (X, Y or Z): the
  // machine leans over to it in mid-move, behind the way to brake, on which a board that is left
  // alone stops, or by a move of its own at the end. What is suspended goes on from the shifted
  // place; what is held begins with the way over to there.
  double shift_from(double ticks, int j, double mm, size_t extruder, size_t tool);
  // Shifts what comes behind all moves so far, by a move of its own.
  void push_shift(int j, double mm, size_t extruder, size_t tool);
  // As replan_from, with another flow of an extruder: from where the way to brake would end, so
  // that the machine can always still stop, what is left moves as much filament as `change` says.
  // What is held changes too.
  double change_flow_from(double ticks, size_t extruder, FlowChange& change);
  // The same for what is suspended.
  void change_flow_aside(size_t extruder, FlowChange& change);

  // Whether `allowed` holds for the ends of all moves that shift_from would shift, each `mm`
  // further.
  bool allows_shift(double ticks, int j, double mm,
                    const std::function<bool(const double*)>& allowed) const;

  // Ends the dwell that is under way at `ticks`, if there is one; returns the clock of the cut.
  std::optional<double> skip_dwell_from(double ticks);

  // Nothing before `ticks` will be planned anew: what makes no step need not be kept for that.
  void pass(double ticks) { passed_ = std::max(passed_, ticks); }

  // As replan_from, but brakes to a stop on the path. What is left of it waits for `release`, with
  // what is held already. A lit laser goes off at the stop, and on again when it goes on. `way`:
  // where the machine has stopped, if other limits held then; 0 if that is not known.
  double hold_from(double ticks, double way = 0);
  // Goes on with what hold_from left.
  void release();
  size_t held() const { return held_.moves.size(); }
  // The tool that hold_from has stopped; nothing if no move is held.
  std::optional<size_t> stopped_tool() const;
  ProgramLines& lines() { return lines_; }
  // Where the plan was at `ticks`, in the last second or so: X, Y, Z, the extruder of that move and
  // further axes. Nothing if that is longer ago.
  std::optional<std::array<double, kAxes>> position_at(double ticks) const;
  // After hold_from: puts what is held aside, with its records, so that other moves may come first,
  // from where the machine stands. `resume` takes it up again; the machine must be back there.
  void suspend();
  bool suspended() const { return aside_.has_value(); }
  const double* stop_position() const { return aside_->stop; }
  void resume();
  // What is put aside will not be taken up again.
  void forget_suspended() { aside_.reset(); }
  // What hold_from has left is forgotten, and its records with it.
  void forget_held() { stand_before(std::exchange(held_, {})); }

 private:
  static constexpr double kSameWay = 1e-9;     // share by which ways differ through rounding
  static constexpr long kOutputsSeen = 32;     // records at one place that are looked through
  static constexpr double kKeptSeconds = 1.0;  // of motion that is under way or done already
  Machine machine_;  // its steps per unit and tool offsets may change while it stands
  Planner planner_;
  bool with_steps_;
  double (*cpu_clock_)();
  Cpu cpu_;
  PlanStatistics plan_;
  StepStream stream_;
  std::deque<Record> records_, placed_, marks_;
  History history_;
  double passed_ = 0;
  Held held_;
  ProgramLines lines_;
  struct Aside {
    Held held;
    double stop[kAxes], end[kAxes];
    std::vector<double> extruders;
    std::vector<int64_t> counts;  // steps of each motor at the stop
  };
  std::optional<Aside> aside_;
  uint32_t unattached_ = 0;  // last records_ that wait for a move to follow
  LaserLight laser_;
  uint32_t light_before_ = 0;  // of records forgotten
  double ticks_of_cut_ = 0;
  bool in_pieces_ = false;  // what comes next may go on from pieces without a stop
  double pieces_end_ = 0;   // ticks

  static void change_flow(std::vector<Move>& moves, size_t extruder, FlowChange& change);
  void resume_plan(std::vector<Move>& moves, double speed2, double clock);
  // After a cut. Where moves are held the plan ends with the stop.
  void go_on(std::vector<Move>& moves, double speed2);
  // After a stop: the next move starts where what is held would have gone on, each extruder where
  // its own moves would.
  void stand_before(const Held& held);
  double now() const { return cpu_clock_ ? cpu_clock_() : 0; }
  void process(bool still);

  // The power that a record has set last; 0 too where it follows the speed.
  uint32_t last_light() const;
  // After a cut between two moves: the one before it has the last word on the laser.
  bool still_following() const;

  // The next n records are due at `ticks`; `alone`: behind a move.
  void place(double ticks, uint32_t n, bool alone);

  // What ended before the last command taken can no longer be replanned.
  void forget();

  // No move before this one will be planned anew; what is held or aside may be older.
  void forget_rules(const Move& oldest);

  void merge(bool all) { stream_.merge(planner_.clock(), all); }

  // Revokes steps, messages and moves from a clock ≥ `ticks` on; that clock goes to ticks_of_cut_,
  // the revoked moves to `rest`. Returns the speed² at the cut.
  double cut(double ticks, std::vector<Move>& rest);
  // Records later than `at` come again, with the moves of the rest that have brought them; those
  // that came behind a move come before the next one, and late ones at once. Returns how many come
  // behind all of them.
  uint32_t take_back(int64_t at, std::vector<Move>& rest, bool under_way);
};

}  // namespace passo
