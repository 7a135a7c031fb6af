// One timeline from planned moves and timed records to the board's messages, in the order of their
// clocks, with the way back: what is not yet sent can be planned anew.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "commits.hpp"
#include "compressor.hpp"
#include "laser.hpp"
#include "message_queue.hpp"
#include "planner.hpp"
#include "statistics.hpp"
#include "step_solver.hpp"

namespace passo {

class Motion {
 public:
  // CPU seconds by stage, measured by the given clock (none: not measured).
  struct Cpu {
    double steps = 0, compress = 0;
  };

  // `with_steps` false: plan only, for estimates.
  Motion(const Machine& machine, bool with_steps, double (*cpu_clock)() = nullptr)
      : machine_(machine), planner_(machine_), with_steps_(with_steps), cpu_clock_(cpu_clock) {
    for (size_t i = 0; with_steps && i < machine_.steppers.size(); ++i) {
      solvers_.emplace_back(machine_, machine_.steppers[i]);
      compressors_.emplace_back(machine_, machine_.steppers[i], uint16_t(i));
    }
    for (size_t i = 0; i < machine_.boards; ++i) {
      messages_.emplace_back();
      messages_[i].join(messages_[0]);
    }
    set_apart_.resize(solvers_.size());
    plan_.filament_mm.resize(machine_.extruders.size());
  }
  Motion(const Motion&) = delete;
  Motion& operator=(const Motion&) = delete;

  const Machine& machine() const { return machine_; }
  Planner& planner() { return planner_; }
  const PlanStatistics& plan() const { return plan_; }
  const Cpu& cpu() const { return cpu_; }
  // Of one board; all their clocks are those of the main one, 0.
  MessageQueue& messages(size_t board = 0) { return messages_[board]; }
  // Messages that wait to be taken.
  size_t waiting() {
    auto held = hold();
    size_t all = 0;
    for (const MessageQueue& queue : messages_) all += queue.size();
    return all;
  }
  const StepStatistics& steps(size_t i) const { return compressors_[i].statistics(); }
  Compressor& compressor(size_t i) { return compressors_[i]; }
  int64_t count(size_t i) const { return solvers_[i].count(); }
  int64_t handed_out() const { return handed_out_; }  // clock of the last of messages(), so far
  // A timed record. Targets from kMark on are the host's own: they come out of marks(), in the
  // order of their clocks, and are not sent.
  static constexpr uint16_t kMark = 0x8000;
  struct Record {
    uint16_t target;
    uint32_t value;
    int64_t clock;
  };
  std::deque<Record>& marks() { return marks_; }
  // Called with each settled move, before its steps are solved.
  std::function<void(const Move&)> on_move;

  void push(const MoveRequest& request) {
    if (std::exchange(in_pieces_, false)) flush();
    if (planner_.push(request, unattached_)) unattached_ = 0;
    if (!planner_.settled().empty()) process(false);
  }

  // Takes pieces, already planned, from where and when the moves pushed so far have ended; `start`s
  // are set here. Each begins where the one before it ends, to kJoint mm, and the first one where
  // the machine is. They are never planned anew: a cut among them falls behind the last. Throws
  // std::invalid_argument, and takes none, if they do not join, or a motor cannot follow.
  static constexpr double kJoint = 1e-6;
  void add_pieces(std::vector<Piece> pieces) {
    if (commits_) throw std::invalid_argument("pieces cannot be stopped on their way");
    if (!in_pieces_) flush();
    check(pieces);
    for (Piece& p : pieces) {
      in_pieces_ = true;
      p.start = planner_.clock();
      plan_.add(p);
      for (size_t i = 0; i < solvers_.size(); ++i) solvers_[i].solve(p, compressors_[i].steps());
      planner_.wait_until(p.start + p.seconds * machine_.clock_hz);
      planner_.set_position(p.end, p.extruder);
      pieces_end_ = planner_.clock();
    }
    process(false);
  }

  // A record for output `target`, due when the moves pushed so far are done.
  void record(uint16_t target, uint32_t value) {
    records_.push_back({target, value, 0});
    ++unattached_;
    if (planner_.queued() == 0) place(planner_.clock(), std::exchange(unattached_, 0));
  }

  // Output `target` is a laser, fully on at `full`.
  void set_laser(uint16_t target, uint32_t full) {
    laser_target_ = target;
    laser_full_ = full;
  }
  // The laser's share of full power, on moves pushed from now on, where they go as fast as they
  // were told to; elsewhere less, as they are slower. 0: records alone set it.
  void follow_speed(double share) { planner_.laser_share = share; }
  // A record for output `target`, due at `ticks` in the midst of the moves. It cannot be revoked:
  // no cut may be asked for at an earlier clock any more.
  void record_at(double ticks, uint16_t target, uint32_t value) {
    auto held = hold();
    int64_t clock = std::max(int64_t(std::ceil(ticks)), taken_until());
    Message m{clock, clock, value, 0, 0, target, MessageKind::pin, 0};
    bool committed = !commits_ || clock <= commits_->points().back().clock;
    MessageQueue& queue = clock >= handed_out_ ? pins_
                          : committed          ? queue_of(m)
                                               : commits_->waiting();
    queue.insert(m);
    merge(false);
  }

  // Settles all, for a stop at the end, and hands out every message.
  void flush() {
    in_pieces_ = false;
    planner_.flush();
    process(true);
  }

  // The machine stands until `ticks`. Only after flush.
  void wait_until(double ticks) { planner_.wait_until(ticks); }

  // Sets where the machine is, without motion. Only after flush.
  void set_position(const double* position, size_t extruder) {
    planner_.set_position(position, extruder);
    for (size_t i = 0; i < solvers_.size(); ++i) {
      const StepperSpec& s = machine_.steppers[i];
      if (s.drive == Drive::extruder && size_t(s.index) != extruder) continue;
      int64_t count = solvers_[i].count_at(position);
      set_apart_[i] += count - solvers_[i].count();
      solvers_[i].set_count(count);
    }
  }
  // Changes how many steps motor i makes for a mm or degree. Only after flush.
  void set_steps_per_unit(size_t i, double value, const double* position) {
    machine_.steppers[i].steps_per_unit = value;
    if (i >= solvers_.size()) return;
    int64_t count = solvers_[i].count_at(position);
    set_apart_[i] += count - solvers_[i].count();
    solvers_[i].set_count(count);
  }
  // From now on the bed adds these heights to Z (none: it is flat). No motor moves: what changes is
  // the Z of the plan, which is then where the machine is. Only after flush.
  void set_height_map(std::shared_ptr<const HeightMap> map) {
    double position[kAxes];
    std::copy_n(planner_.position(), kAxes, position);
    double height = machine_.raised(position);
    machine_.height_map = std::move(map);
    position[kZ] = height - (machine_.raised(position) - position[kZ]);
    planner_.set_position(position, machine_.extruders.size());
  }
  // While `on`, X, Y and Z of all positions are those of the first three actuators of a nonlinear
  // geometry, each of which moves by itself. Only while the machine stands; where it is must be set
  // after either change.
  void use_joints(bool on) { machine_.joints = on && planner_.constraints().actuators.size() >= 3; }
  void set_tool_offset(size_t tool, int j, double mm) { machine_.tools[tool].offset[j] = mm; }

  // From now on messages come in commits (commits.hpp): each of at most `period` ticks and `most`
  // messages. Only while the machine stands and nothing is waiting. The last
  // kKeptCommits that were taken are kept for recover_from().
  void use_commits(int64_t period, size_t most) {
    commits_.emplace(machine_, period, most);
    begin_commits(0, 0);
  }
  void stop_commits() { commits_.reset(); }
  bool commits() const { return commits_.has_value(); }

  // The board was left alone: it has come to a stop behind the commit `serial`, as that told it to.
  // Plans anew from there; what was to follow is held, and `release` goes on with it at any later
  // clock; expected_net() tells where each motor must be by now. Outputs that were to change on the
  // way change when it goes on. Returns the clock of the commit; nothing, and nothing is changed,
  // if that is not known any more.
  std::optional<double> recover_from(uint32_t serial) {
    if (!commits_) return std::nullopt;
    auto held = hold();
    const auto& points = commits_->points();
    auto p = std::find_if(points.begin(), points.end(),
                          [&](const Commits::Point& x) { return x.serial == serial; });
    if (p == points.end()) return std::nullopt;
    double clock = double(p->clock);
    if (commits_->begins_with(*p))
      messages_[0].rewind(p->clock);
    else if (!messages_[0].rewind_behind(serial))
      return std::nullopt;
    if (held_.empty()) hold_from(clock);
    std::deque<Record> late;
    for (; !messages_[0].empty(); messages_[0].pop())
      if (const Message& m = messages_[0].front();
          m.kind == MessageKind::pin && m.target != laser_target_)
        late.push_back({m.target, m.interval, m.clock});
    (held_.empty() ? unattached_ : held_.front().records) += uint16_t(late.size());
    records_.insert(records_.begin(), late.begin(), late.end());
    for (size_t i = 0; i < compressors_.size(); ++i) compressors_[i].renew();
    begin_commits(serial, int64_t(planner_.clock()));
    return clock;
  }

  // After an endstop has stopped motors on the board: the next step of motor i tells its clock and
  // direction anew. Only after flush; where the motor is must be set then.
  void renew(size_t i) { compressors_[i].renew(); }
  // Net steps that motor i was to make: its rounded targets, less what positions were set without
  // motion.
  int64_t expected_net(size_t i) const { return solvers_[i].count() - set_apart_[i]; }

  // Cuts every stepper at the first clock ≥ `ticks` that is not bound by a command already taken
  // from messages(), and goes on from the speed that the machine has there, each move by its rules.
  // Returns that clock.
  double replan_from(double ticks) {
    std::vector<Move> rest;
    double speed2 = cut(ticks, rest);
    resume_plan(rest, speed2, ticks_of_cut_);
    process(false);
    return ticks_of_cut_;
  }

  // As replan_from, and all that is still to come lies `mm` further along slot j (X, Y or Z): the
  // machine leans over to it in mid-move, or by a move of its own at the end. What is suspended
  // goes on from the shifted place. Not while moves are held, but not suspended.
  double shift_from(double ticks, int j, double mm, size_t extruder) {
    if (aside_) {
      for (Move& m : aside_->moves) m.p0[j] += mm, m.p1[j] += mm;
      aside_->stop[j] += mm;
      aside_->end[j] += mm;
      return planner_.clock();
    }
    std::vector<Move> rest;
    double speed2 = cut(ticks, rest);
    planner_.take_queue(rest);
    double left = planner_.shift(rest, speed2, j, mm);
    resume_plan(rest, speed2, ticks_of_cut_);
    process(false);
    if (left != 0) push_shift(j, left, extruder);
    return ticks_of_cut_;
  }
  // Shifts what comes behind all moves so far, by a move of its own.
  void push_shift(int j, double mm, size_t extruder) {
    MoveRequest m{};
    std::copy_n(planner_.position(), kAxes, m.target);
    m.target[j] += mm;
    if (extruder < machine_.extruders.size()) m.target[kE] = planner_.extruder_position(extruder);
    m.extruder = uint16_t(extruder);
    m.feed_mm_s = m.radius_mm = kInfinity;
    m.kind = MoveKind::travel;
    m.moved = uint8_t(1u << j);
    push(m);
  }
  // Whether `allowed` holds for the ends of all moves that shift_from would shift, each `mm`
  // further.
  bool allows_shift(double ticks, int j, double mm,
                    const std::function<bool(const double*)>& allowed) const {
    auto beside = [&](const double* end) {
      double p[kAxes];
      std::copy_n(end, kAxes, p);
      p[j] += mm;
      return allowed(p);
    };
    auto ends = [&](const Move& m) { return beside(m.p1); };
    if (ticks == kInfinity && !aside_) return beside(planner_.position());
    if (aside_)
      return beside(aside_->stop) && beside(aside_->end) &&
             std::all_of(aside_->moves.begin(), aside_->moves.end(), ends);
    return std::all_of(history_.begin(), history_.end(),
                       [&](const Move& m) { return m.end() <= ticks || ends(m); }) &&
           planner_.all_queued(ends) && beside(planner_.position());
  }

  // Ends the dwell that is under way at `ticks`, if there is one; returns the clock of the cut.
  std::optional<double> skip_dwell_from(double ticks) {
    auto m = std::find_if(history_.begin(), history_.end(),
                          [&](const Move& x) { return x.end() > ticks; });
    if (m == history_.end() || m->kind != MoveKind::dwell || m->start > ticks) return std::nullopt;
    double start = m->start;
    std::vector<Move> rest;
    double speed2 = cut(ticks, rest);
    bool still_there = !rest.empty() && rest[0].kind == MoveKind::dwell && rest[0].start <= start;
    if (still_there) rest[0].duration = 0;
    resume_plan(rest, speed2, ticks_of_cut_);
    process(false);
    return ticks_of_cut_;
  }

  // As replan_from, but brakes to a stop on the path. What is left of it waits for `release`.
  double hold_from(double ticks) {
    std::vector<Move> rest;
    double speed2 = cut(ticks, rest);
    planner_.take_queue(rest);
    planner_.stand(ticks_of_cut_);
    std::vector<Move> braking;
    size_t i = 0;
    for (double v2 = speed2; i < rest.size() && v2 > 0; ++i)
      if (brake(rest[i], v2, braking)) break;
    held_.assign(rest.begin() + long(i), rest.end());
    // Records behind the last move held are not due at the stop.
    uint16_t behind = held_.empty() ? uint16_t(0) : std::exchange(unattached_, uint16_t(0));
    resume_plan(braking, speed2, ticks_of_cut_);
    flush();
    unattached_ = behind;
    dark_ = last_light();
    if (dark_ > 0) put_light(0);
    return ticks_of_cut_;
  }
  // Goes on with what hold_from left.
  void release() {
    std::vector<Move> rest;
    rest.swap(held_);
    planner_.rules().renumber(rest);
    if (dark_ > 0) put_light(std::exchange(dark_, 0u));
    resume_plan(rest, 0, planner_.clock());
    process(false);
  }
  size_t held() const { return held_.size(); }
  // Line of the program whose move is under way, or was the last one, at `ticks` (0: none). Asked
  // for clocks that only grow.
  uint32_t line_at(double ticks) {
    keeps_lines_ = true;
    double oldest = ticks - kLinesKeptSeconds * machine_.clock_hz;
    while (lines_.size() > 1 && lines_[1].start <= oldest) lines_.pop_front();
    return lines_.empty() || lines_[0].start > ticks ? 0 : line_near(ticks);
  }
  // The same for any clock from a second before the last line_at() on.
  uint32_t line_near(double ticks) const {
    auto behind = std::upper_bound(lines_.begin(), lines_.end(), ticks,
                                   [](double t, const Line& line) { return t < line.start; });
    if (lines_.empty()) return 0;
    return (behind == lines_.begin() ? behind : behind - 1)->number;
  }
  // Where the plan was at `ticks`, in the last second or so: X, Y, Z, the extruder of that move and
  // further axes. Nothing if that is longer ago.
  std::optional<std::array<double, kAxes>> position_at(double ticks) const {
    auto next = std::upper_bound(history_.begin(), history_.end(), ticks,
                                 [](double t, const Move& m) { return t < m.start; });
    if (next == history_.begin()) return std::nullopt;
    const Move& m = *std::prev(next);
    std::array<double, kAxes> p;
    if (ticks >= m.end()) {  // it stands, perhaps where it was told that it is
      std::copy_n(next != history_.end() ? next->p0 : planner_.next_start(), kAxes, p.begin());
      return p;
    }
    double part = m.kind == MoveKind::dwell ? 1 : along(m, ticks - m.start).first / m.d;
    for (size_t j = 0; j < p.size(); ++j) p[j] = m.p0[j] + (m.p1[j] - m.p0[j]) * part;
    return p;
  }
  // After hold_from: puts what is held aside, with its records, so that other moves may come first,
  // from where the machine stands. `resume` takes it up again; the machine must be back there.
  void suspend() {
    Aside aside;
    aside.records.swap(records_);
    aside.moves.swap(held_);
    aside.unattached = std::exchange(unattached_, 0);
    std::copy_n(planner_.position(), kAxes, aside.end);
    for (size_t i = 0; i < machine_.extruders.size(); ++i)
      aside.extruders.push_back(planner_.extruder_position(i));
    if (!aside.moves.empty())
      planner_.set_position(aside.moves.front().p0, aside.moves.front().extruder);
    std::copy_n(planner_.position(), kAxes, aside.stop);
    for (const StepSolver& solver : solvers_) aside.counts.push_back(solver.count());
    aside_ = std::move(aside);
  }
  bool suspended() const { return aside_.has_value(); }
  const double* stop_position() const { return aside_->stop; }
  void resume() {
    planner_.set_position(aside_->end, 0);
    for (size_t i = 0; i < aside_->extruders.size(); ++i) {
      double position[kAxes];
      std::copy_n(aside_->end, kAxes, position);
      position[kE] = aside_->extruders[i];
      planner_.set_position(position, i);
    }
    planner_.set_position(aside_->end, machine_.extruders.size());
    // Filament that was moved meanwhile stays where it is.
    for (size_t i = 0; i < solvers_.size(); ++i) {
      if (machine_.steppers[i].drive != Drive::extruder) continue;
      set_apart_[i] += aside_->counts[i] - solvers_[i].count();
      solvers_[i].set_count(aside_->counts[i]);
    }
    held_.swap(aside_->moves);
    records_.swap(aside_->records);
    unattached_ = aside_->unattached;
    aside_.reset();
    release();
  }
  // What is put aside will not be taken up again.
  void forget_suspended() { aside_.reset(); }
  // As hold_from, but what is left is forgotten, and its records with it.
  double stop_from(double ticks) {
    double cut = hold_from(ticks);
    dark_ = 0;
    if (!held_.empty()) {
      planner_.set_position(held_.front().p0, held_.front().extruder);
      held_.clear();
      records_.clear();
      unattached_ = 0;
    }
    return cut;
  }

 private:
  static constexpr double kKeptSeconds = 1.0;  // of motion that is under way or done already
  static constexpr size_t kKeptCommits = 128;  // more than the frames on their way can hold
  Machine machine_;  // its steps per unit and tool offsets may change while it stands
  Planner planner_;
  bool with_steps_;
  double (*cpu_clock_)();
  Cpu cpu_;
  PlanStatistics plan_;
  std::vector<StepSolver> solvers_;
  std::vector<int64_t> set_apart_;  // steps by which positions were set without motion
  std::deque<Compressor> compressors_;
  std::deque<MessageQueue> messages_;  // by board
  MessageQueue pins_;
  std::optional<Commits> commits_;     // only of a board that is alone
  std::vector<MessageQueue*> merged_;  // pins_ and those of the compressors
  std::vector<int64_t> next_clocks_;   // of each of them
  std::deque<Record> records_, placed_, marks_;
  std::vector<Move> history_;
  size_t history_begin_ = 0;  // moves before it are forgotten
  std::vector<Move> held_;
  static constexpr double kLinesKeptSeconds = 1;
  bool keeps_lines_ = false;
  struct Line {
    double start;
    uint32_t number;
  };
  std::deque<Line> lines_;  // of moves of the program
  struct Aside {
    std::vector<Move> moves;
    std::deque<Record> records;
    uint16_t unattached = 0;
    double stop[kAxes], end[kAxes];
    std::vector<double> extruders;
    std::vector<int64_t> counts;  // steps of each motor at the stop
  };
  std::optional<Aside> aside_;
  uint16_t unattached_ = 0;                        // last records_ that wait for a move to follow
  static constexpr uint16_t kNoLaser = kMark - 1;  // no output has this number
  uint16_t laser_target_ = kNoLaser;
  uint32_t laser_full_ = 0, light_ = 0;   // light_: the last value sent while following_
  uint32_t light_before_ = 0, dark_ = 0;  // of records forgotten; what a stop has switched off
  bool following_ = false;                // the laser's power is that of the speed, not of a record
  int64_t handed_out_ = 0;                // clock of the last message merged
  double ticks_of_cut_ = 0;
  bool in_pieces_ = false;  // what comes next may go on from pieces without a stop
  double pieces_end_ = 0;   // ticks

  void check(const std::vector<Piece>& pieces) const {
    const double* from = planner_.position();
    for (const Piece& p : pieces) {
      if (!(p.seconds > 0 && p.seconds < kInfinity))
        throw std::invalid_argument("a piece needs a time above 0");
      for (int j = 0; j < kAxes; ++j) {
        double before = j == kE && p.extruder < machine_.extruders.size() && &p == pieces.data()
                            ? planner_.extruder_position(p.extruder)
                            : from[j];
        // Written so that numbers that are none fail too.
        if (!(std::fabs(p.c[j][0] - before) <= kJoint))
          throw std::invalid_argument("a piece does not start where the one before it ends");
        if (!(std::fabs(p.position(j, p.seconds) - p.end[j]) <= kJoint))
          throw std::invalid_argument("a piece does not end where it says");
      }
      from = p.end;
      for (const StepperSpec& spec : machine_.steppers) PieceSolver(machine_, spec).check(p);
    }
  }

  std::unique_lock<std::recursive_mutex> hold() { return messages_[0].hold(); }
  int64_t taken_until() const {
    int64_t latest = 0;
    for (const MessageQueue& queue : messages_) latest = std::max(latest, queue.taken_until());
    return latest;
  }
  // The queue of the board that is to have a message.
  MessageQueue& queue_of(const Message& m) {
    if (m.kind != MessageKind::pin) return messages_[machine_.steppers[m.target].board];
    const std::vector<uint16_t>& boards = machine_.output_boards;
    return messages_[m.target < boards.size() ? boards[m.target] : 0];
  }
  // Puts into `braking` the part of a move in which the machine comes to a stop from speed² v2, or
  // all of it, and takes what that costs from v2. True if a part of the move is left, which is `m`
  // then.
  static bool brake(Move& m, double& v2, std::vector<Move>& braking) {
    double reach = 2 * m.b * m.d, part = v2 / reach;
    if (part < 1 - 1e-9) {
      Move first = m;
      Bounds::cut(m, 0, part, first);
      Move second = m;
      Bounds::cut(m, part, 1, second);
      second.inner = true;
      second.records = 0;
      braking.push_back(first);
      m = second;
      v2 = 0;
      return true;
    }
    braking.push_back(m);
    v2 = part <= 1 ? 0 : v2 - reach;
    return false;
  }
  // How the machine would stop on its path from `clock` on.
  void brake_from(int64_t clock, std::vector<Move>& moves) const {
    auto under_way = std::partition_point(history_.begin() + long(history_begin_), history_.end(),
                                          [&](const Move& m) { return m.end() <= double(clock); });
    double v2 = planner_.speed2();
    auto next = [&](const Move& m) {
      Move copy = m;
      if (v2 > 0) brake(copy, v2, moves);
      return v2 > 0;
    };
    bool goes_on = true;
    if (under_way != history_.end()) {
      const Move& m = *under_way;
      if (m.kind == MoveKind::dwell || m.start >= double(clock)) {
        v2 = m.v0 * m.v0;
        goes_on = m.kind != MoveKind::dwell && next(m);
      } else {
        auto [s, v] = along(m, double(clock) - m.start);
        v2 = v * v;
        Move left = m;
        Bounds::cut(m, s / m.d, 1, left);
        goes_on = next(left);
      }
      for (++under_way; goes_on && under_way != history_.end(); ++under_way)
        goes_on = next(*under_way);
    }
    if (goes_on) planner_.all_queued(next);
    double start = double(clock), hz = machine_.clock_hz, v = 0;
    if (!moves.empty()) {
      // The speed at the start, from what it takes to stop.
      double way = 0;
      for (const Move& m : moves) way += 2 * m.b * m.d;
      v = std::sqrt(way);
    }
    for (Move& m : moves) {
      m.v0 = m.vc = v;
      m.v1 = v = std::sqrt(std::max(0.0, v * v - 2 * m.b * m.d));
      m.a = m.b;
      m.d_acc = m.d_cru = m.t_acc = m.t_cru = 0;
      m.t_dec = (m.v0 - m.v1) / m.b * hz;
      m.start = start;
      start = m.end();
    }
  }
  // The board's last commit is `serial`, and the machine stands.
  void begin_commits(uint32_t serial, int64_t clock) {
    auto held = hold();
    messages_[0].keep(kKeptCommits);
    std::vector<bool> renews;
    for (const Compressor& c : compressors_) renews.push_back(c.renews());
    commits_->begin(serial, clock, last_steps(), nets(), std::move(renews));
  }
  // Of each motor, at rest: the clock of its last step, its net steps.
  std::vector<int64_t> last_steps() const {
    std::vector<int64_t> last;
    for (const Compressor& c : compressors_) last.push_back(c.last());
    return last;
  }
  std::vector<int64_t> nets() const {
    std::vector<int64_t> net;
    for (size_t i = 0; i < solvers_.size(); ++i) net.push_back(expected_net(i));
    return net;
  }
  // Hands out what is certain; `stands` where the machine stands, or kNoMessage.
  void commit(int64_t known, int64_t stands) {
    if (!commits_) return;
    auto held = hold();
    auto brake = [this](int64_t clock, std::vector<Move>& moves) { brake_from(clock, moves); };
    commits_->advance(known, stands, set_apart_, brake, messages_[0]);
    commits_->forget(messages_[0].taken_until(), kKeptCommits);
  }

  void resume_plan(std::vector<Move>& moves, double speed2, double clock) {
    unattached_ += planner_.resume(std::move(moves), speed2, clock);
  }
  double now() const { return cpu_clock_ ? cpu_clock_() : 0; }
  void process(bool still) {
    double start = now();
    std::vector<Move>& moves = planner_.settled();
    for (const Move& m : moves) {
      plan_.add(m, machine_.clock_hz, 1);
      place(m.start, m.records);
      if (with_steps_) light(m);
      if (on_move) on_move(m);
      if (keeps_lines_ && m.line > 0 && (lines_.empty() || lines_.back().number != m.line))
        lines_.push_back({m.start, m.line});
    }
    if (still) {
      dim(planner_.clock());
      place(planner_.clock(), std::exchange(unattached_, 0));
    }
    if (with_steps_) {
      for (size_t i = 0; i < solvers_.size(); ++i)
        for (const Move& m : moves) solvers_[i].solve(m, compressors_[i].steps());
      double solved = now();
      cpu_.steps += solved - start;
      for (Compressor& c : compressors_) c.advance(planner_.clock(), still);
      forget();
      history_.insert(history_.end(), moves.begin(), moves.end());
      if (history_begin_ < history_.size()) forget_rules(history_[history_begin_]);
      merge(still);
      if (still) commit(kNoMessage, int64_t(std::ceil(planner_.clock())));
      cpu_.compress += now() - solved;
    } else if (!moves.empty()) {
      forget_rules(moves.back());
    }
    moves.clear();
  }

  // The power that a record has set last; 0 too where it follows the speed.
  uint32_t last_light() const {
    uint32_t value = light_before_;
    for (const Record& r : placed_)
      if (r.target == laser_target_) value = r.value;
    return value;
  }
  // At the end of a plan that stands.
  void put_light(uint32_t value) {
    records_.push_front({laser_target_, value, 0});
    place(planner_.clock(), 1);
    merge(true);
    commit(kNoMessage, int64_t(std::ceil(planner_.clock())));
  }
  // Power that follows the speed of a move; off when the next one is none that has it.
  void light(const Move& m) {
    if (m.duty == 0) return dim(m.start);
    if (m.kind == MoveKind::dwell) {
      set_light(m.start, uint32_t(std::min(1.0, m.duty) * laser_full_ + 0.5));
      return;
    }
    double mm2 = 0, longest = 0;
    for (int j = 0; j < kAxes; ++j) {
      double mm = std::fabs(m.p1[j] - m.p0[j]);
      longest = std::max(longest, mm);
      if (j <= kZ) mm2 += mm * mm;
    }
    double duty = m.duty * (m.cartesian ? std::sqrt(mm2) : longest) / m.d;
    each_speed(m, machine_.clock_hz, [&](double ticks, double speed) {
      set_light(ticks, uint32_t(std::min(1.0, duty * speed) * laser_full_ + 0.5));
    });
    following_ = true;
  }
  // After a cut between two moves: the one before it has the last word on the laser.
  bool still_following() const {
    if (history_.empty() || history_.back().duty == 0) return false;
    for (const Record& r : placed_)
      if (r.target == laser_target_ && double(r.clock) >= history_.back().end() - 1) return false;
    return true;
  }
  void dim(double ticks) {
    if (std::exchange(following_, false)) set_light(ticks, 0);
  }
  void set_light(double ticks, uint32_t value) {
    if (following_ && value == light_) return;
    following_ = true;
    light_ = value;
    int64_t clock = std::max(int64_t(std::floor(ticks + 0.5)), handed_out_);
    pins_.insert({clock, clock, value, 0, 0, laser_target_, MessageKind::pin, 0});
  }

  // The next n records are due at `ticks`.
  void place(double ticks, uint16_t n) {
    for (; n > 0; --n) {
      Record r = records_.front();
      records_.pop_front();
      r.clock = std::max(int64_t(std::floor(ticks + 0.5)), handed_out_);
      if (r.target >= kMark)
        marks_.push_back(r);
      else
        pins_.insert({r.clock, r.clock, r.value, 0, 0, r.target, MessageKind::pin, 0});
      if (r.target == laser_target_) following_ = false;
      placed_.push_back(r);
    }
  }

  // What ended before the last command taken can no longer be replanned.
  void forget() {
    auto held = hold();
    double taken = double(taken_until());
    double past = taken - kKeptSeconds * machine_.clock_hz;
    if (commits_) past = std::min(past, double(commits_->points().front().clock));
    while (history_begin_ < history_.size() && history_[history_begin_].end() < past)
      ++history_begin_;
    if (2 * history_begin_ >= history_.size()) {
      history_.erase(history_.begin(), history_.begin() + long(history_begin_));
      history_begin_ = 0;
    }
    for (; !placed_.empty() && double(placed_.front().clock) < past; placed_.pop_front())
      if (placed_.front().target == laser_target_) light_before_ = placed_.front().value;
    for (Compressor& c : compressors_) c.forget_resets(int64_t(past));
  }

  // No move before this one will be planned anew; what is held or aside may be older.
  void forget_rules(const Move& oldest) {
    if (held_.empty() && !aside_) planner_.rules().forget_before(oldest.rules);
  }

  // Moves to messages_, each to its board, all that no later message can precede.
  void merge(bool all) {
    auto held = hold();
    double limit = planner_.clock();
    for (Compressor& c : compressors_) limit = std::min(limit, c.next_clock(planner_.clock()));
    // Which comes next is as good as random: the comparisons must not be branches.
    std::vector<MessageQueue*>& queues = merged_;
    queues.assign(1, &pins_);
    for (Compressor& c : compressors_) queues.push_back(&c.messages());
    next_clocks_.clear();
    for (MessageQueue* queue : queues) next_clocks_.push_back(queue->next_clock());
    const int64_t end = all ? kNoMessage : int64_t(std::ceil(limit));
    for (;;) {
      int64_t clock = next_clocks_[0];
      size_t first = 0;
      for (size_t i = 1; i < queues.size(); ++i) {
        bool sooner = next_clocks_[i] < clock;
        clock = sooner ? next_clocks_[i] : clock;
        first = sooner ? i : first;
      }
      if (clock >= end) break;
      const Message& next = queues[first]->front();
      (commits_ ? commits_->waiting() : queue_of(next)).push(next);
      handed_out_ = std::max(handed_out_, next.clock);
      queues[first]->pop();
      next_clocks_[first] = queues[first]->next_clock();
    }
    if (!all) commit(end, kNoMessage);
    if (all)
      for (Compressor& c : compressors_) c.not_before(handed_out_);
  }

  // Revokes steps, messages and moves from a clock ≥ `ticks` on; that clock goes to ticks_of_cut_,
  // the revoked moves to `rest`. Returns the speed² at the cut.
  double cut(double ticks, std::vector<Move>& rest) {
    auto held = hold();  // what the link has taken stays as it is until all is cut
    merge(true);
    in_pieces_ = false;
    int64_t at = std::max(int64_t(std::ceil(std::max(ticks, pieces_end_))), taken_until());
    ticks_of_cut_ = std::min(double(at), planner_.clock());
    double speed2 = planner_.speed2();
    if (double(at) >= planner_.clock()) {
      planner_.rewind_budget(rest);
      return speed2;
    }
    // Steps that wait for more of their kind may be due before the cut: they become commands now.
    for (Compressor& c : compressors_) c.advance(planner_.clock(), true);
    merge(true);
    revoke_messages(at);
    while (!lines_.empty() && lines_.back().start >= ticks_of_cut_) lines_.pop_back();
    size_t taken_back = 0, at_the_end = 0;
    for (; !placed_.empty() && placed_.back().clock > at; ++taken_back) {
      if (at_the_end == taken_back && double(placed_.back().clock) >= planner_.clock() - 1)
        ++at_the_end;
      records_.push_front(placed_.back());
      placed_.pop_back();
    }
    while (!marks_.empty() && marks_.back().clock > at) marks_.pop_back();
    size_t first = history_.size();
    while (first > history_begin_ && history_[first - 1].end() > ticks_of_cut_) --first;
    for (size_t i = first; i < history_.size(); ++i) {
      plan_.add(history_[i], machine_.clock_hz, -1);
      rest.push_back(history_[i]);
    }
    history_.resize(first);
    bool midway = !rest.empty() && rest[0].start < ticks_of_cut_;
    following_ = midway ? rest[0].duty > 0 : still_following();
    light_ = laser_full_ + 1;  // what is kept of it is not known
    // Records that no move of the rest brings along were due at the end of the plan, or late.
    size_t brought = 0;
    for (const Move& m : rest) brought += m.start >= ticks_of_cut_ ? m.records : 0;
    size_t alone = taken_back - std::min(taken_back, brought);
    at_the_end = std::min(at_the_end, alone);
    bool under_way = !rest.empty() && rest[0].start < ticks_of_cut_;
    size_t late = under_way ? alone - at_the_end : 0;
    if (!planner_.attach(uint16_t(alone - late))) unattached_ += uint16_t(alone - late);
    if (!rest.empty() && rest[0].start < ticks_of_cut_)
      speed2 = cut_move(rest);
    else if (!rest.empty())
      speed2 = rest[0].v0 * rest[0].v0;
    if (late > 0) rest[0].records = uint16_t(late);
    planner_.rewind_budget(rest);
    return speed2;
  }

  // rest[0] is under way at the cut: its first part is history, the second part takes its place.
  double cut_move(std::vector<Move>& rest) {
    Move done = rest[0];
    double tau = ticks_of_cut_ - done.start;
    if (done.kind == MoveKind::dwell) {
      rest[0].ahead0 += (done.ahead1 - done.ahead0) * (tau / done.ticks());
      done.t_cru = tau;
      rest[0].duration -= tau / machine_.clock_hz;
      finish(rest, done);
      return 0;
    }
    auto [s, v] = along(done, tau);
    double part = s / done.d;
    Move left = done;
    Bounds::cut(done, part, 1, left);
    Bounds::cut(Move(done), 0, part, done);
    done.d_acc = std::min(done.d_acc, s);
    done.d_cru = std::min(done.d_cru, s - done.d_acc);
    done.t_dec = std::max(0.0, tau - done.t_acc - done.t_cru);
    done.t_cru = std::clamp(tau - done.t_acc, 0.0, done.t_cru);
    done.t_acc = std::min(tau, done.t_acc);
    left.inner = true;
    left.ahead0 += (left.ahead1 - left.ahead0) * (tau / rest[0].ticks());
    rest[0] = left;
    finish(rest, done);
    return v * v;
  }
  // Way and speed of a move, `tau` ticks after its start.
  std::pair<double, double> along(const Move& m, double tau) const {
    double hz = machine_.clock_hz;
    double t0 = std::min(tau, m.t_acc) / hz, t1 = std::clamp(tau - m.t_acc, 0.0, m.t_cru) / hz;
    double t2 = std::clamp(tau - m.t_acc - m.t_cru, 0.0, m.t_dec) / hz;
    double s = m.v0 * t0 + 0.5 * m.a * t0 * t0 + m.vc * t1 + m.vc * t2 - 0.5 * m.b * t2 * t2;
    double v = t2 > 0 ? m.vc - m.b * t2 : tau > m.t_acc ? m.vc : m.v0 + m.a * t0;
    return {std::clamp(s, 0.0, m.d), v};
  }
  void finish(std::vector<Move>& rest, const Move& done) {
    rest[0].records = 0;
    plan_.add(done, machine_.clock_hz, 1);
    history_.push_back(done);
  }

  // Keeps of messages_ what is executed up to `at`, and sets every motor back to its last step
  // kept.
  void revoke_messages(int64_t at) {
    size_t n = compressors_.size();
    std::vector<StepStatistics> revoked(n);
    std::vector<int64_t> last(n);
    std::vector<bool> cut_off(n, false);
    for (size_t i = 0; i < n; ++i) last[i] = compressors_[i].last();
    int64_t floor = at;
    for (MessageQueue& queue : messages_)
      floor = std::max(floor, revoke(queue, at, revoked, last, cut_off));
    pins_.clear();
    handed_out_ = floor;
    for (size_t i = 0; i < n; ++i) {
      solvers_[i].set_count(solvers_[i].count() - compressors_[i].pending_net() - revoked[i].net);
      compressors_[i].restart(last[i], revoked[i]);
      compressors_[i].not_before(floor);
    }
    if (commits_) commits_->resume(std::move(last), nets());
  }
  // Returns the latest clock of what is kept, or `at`.
  int64_t revoke(MessageQueue& queue, int64_t at, std::vector<StepStatistics>& revoked,
                 std::vector<int64_t>& last, std::vector<bool>& cut_off) {
    std::vector<Message> kept;
    size_t committed = 0;  // of these
    if (commits_)
      for (; !commits_->waiting().empty(); commits_->waiting().pop())
        queue.push(commits_->waiting().front());
    // Directions and clocks go with the steps behind.
    std::vector<std::vector<Message>> ahead(compressors_.size());
    for (size_t i = 0; i < queue.size(); ++i) {
      Message m = queue[i];
      if (m.kind == MessageKind::pin || m.kind == MessageKind::tail ||
          m.kind == MessageKind::commit) {
        if (m.clock <= at) kept.push_back(m);
        if (m.clock <= at && m.kind == MessageKind::commit) committed = kept.size();
        continue;
      }
      if (m.kind != MessageKind::queue_step) {
        ahead[m.target].push_back(m);
        continue;
      }
      int64_t start = m.end_clock - span(m, m.count), count = m.count;
      while (count > 0 && start + span(m, count) > at) --count;
      int64_t lost = m.count - count;
      if (count > 0)
        kept.insert(kept.end(), ahead[m.target].begin(), ahead[m.target].end());
      else
        for (const Message& a : ahead[m.target])
          if (a.kind == MessageKind::reset_clock)
            start = compressors_[m.target].before_reset(a.clock);
      ahead[m.target].clear();
      if (lost > 0) {
        revoked[m.target].steps += lost;
        revoked[m.target].net += m.dir ? lost : -lost;
        if (!cut_off[m.target]) last[m.target] = start + span(m, count);
        cut_off[m.target] = true;
      }
      if (count == 0) {
        ++revoked[m.target].commands;
        continue;
      }
      m.count = uint16_t(count);
      m.end_clock = start + span(m, count);
      kept.push_back(m);
    }
    queue.clear();
    int64_t floor = kept.empty() ? at : std::max(at, kept.back().clock);
    if (commits_) {
      commits_->revoke(at);
      commits_->put_back({kept.begin() + long(committed), kept.end()});
      kept.resize(committed);
    }
    for (const Message& m : kept) queue.push(m);
    return floor;
  }
  static int64_t span(const Message& m, int64_t count) {
    return int64_t(m.interval) * count + int64_t(m.add) * (count * (count - 1) / 2);
  }
};

}  // namespace passo
