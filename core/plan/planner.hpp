// Look-ahead on v² with constant acceleration. Moves go in, settled trapezoids come out; settled
// moves depend neither on later moves nor on how the input was split.
#pragma once
#include <cstdint>
#include <functional>
#include <vector>

#include "machine/machine.hpp"
#include "plan/babystep_ramp.hpp"
#include "plan/bounds.hpp"
#include "plan/budget.hpp"
#include "plan/extrusion_flow.hpp"
#include "plan/junction.hpp"
#include "plan/move.hpp"
#include "plan/move_limits.hpp"

namespace passo {

class Planner {
 public:
  // Moves that arrive between two passes over the queue.
  static constexpr size_t kBatch = 256;
  // Moves in the queue at which the older half settles, for a stop at the end of the queue.
  static constexpr size_t kMaxQueued = 8192;

  explicit Planner(const Machine& machine)
      : clock_hz_(machine.clock_hz), rules_(machine), bounds_(machine), junction_(machine),
        budget_(machine), extruder_(machine.extruders.size(), 0.0) {
    for (const Extruder& e : machine.extruders) advance.push_back(e.advance_s);
  }

  // Rules of later moves; earlier ones keep theirs.
  RuleBook& rules() { return rules_; }
  const RuleBook& rules() const { return rules_; }
  const Constraints& constraints() const { return *rules_.now().constraints; }
  double laser_share = 0;       // laser's fraction of full power at the feedrate of later moves
  std::vector<double> advance;  // pressure advance of later moves, s, by extruder

  // Settled moves that the caller has not taken yet; it clears the vector.
  std::vector<Move>& settled() { return settled_; }
  size_t queued() const { return queue_.size() - head_; }
  // Minimum duration of the queued moves in ticks: at nominal speed, without acceleration.
  double queued_ticks() const;
  double clock() const { return clock_; }    // end of the last settled move, ticks
  double speed2() const { return speed2_; }  // its end speed, squared

  const double* position() const { return position_; }  // end of the last move pushed
  // Start of the first queued move, or of the next move.
  const double* next_start() const { return queued() > 0 ? queue_[head_].p0 : position_; }
  double extruder_position(size_t i) const { return extruder_[i]; }
  // Sets another geometry of the machine. Only while nothing is queued.
  void use_geometry() { budget_.use_geometry(); }
  // Sets where the next move starts, without motion. Only while nothing is queued.
  void set_position(const double* position, size_t extruder);
  // Shifts the start of the next move by `mm` along slot j. Only while nothing is queued.
  void move_end(int j, double mm) { position_[j] += mm; }
  // The settled plan ends at standstill.
  bool rests() const { return speed2_ == 0; }
  // The machine is at standstill until `ticks`. Only while the plan ends at standstill.
  void wait_until(double ticks);

  // Appends a move with `records` timed records due at its start. False if the move is dropped: it
  // covers no distance, or would take longer than kMaxMoveS, see too_slow().
  bool push(const MoveRequest& r, uint32_t records);

  // If the last pushed move was too slow: its duration in seconds, and the limit that bounds its
  // speed. Otherwise 0.
  double too_slow() const { return too_slow_; }
  LimitId slowed_by() const { return slowed_by_; }

  // Settles all queued moves, for a stop at their end.
  void flush() { settle(true); }

  // Plans again `rest`, which was settled before, and the queue, each move by its own rules, from
  // speed² `speed2` at `clock`. Where a rule asks for less speed than the machine has, it brakes as
  // hard as the old plan could. Returns the number of records whose moves are dropped and have no
  // move after them.
  uint32_t resume(std::vector<Move> rest, double speed2, double clock);

  // The plan is cut before `rest`, or if that is empty before the queue: the budget goes back to
  // there.
  void rewind_budget(const std::vector<Move>& rest);

  // Adds records to the start of the first queued move. Returns false if no move is queued.
  bool attach(uint32_t records);

  // Returns whether `allowed` is true for all queued moves.
  bool all_queued(const std::function<bool(const Move&)>& allowed) const;

  // Shifts the queue so that it starts at the end of `rest`.
  void take_queue(std::vector<Move>& rest);

  // Shifts moves that take_queue has completed, and the start of the next move, see Shift.
  double shift(std::vector<Move>& moves, int j, double mm);

  // The next move of this extruder starts where a change of its flow has put the filament.
  void place_filament(size_t extruder, const FlowChange& change);

  // Drops the queue: the machine is at standstill from `clock` on.
  void stand(double clock);

 private:
  double clock_hz_;
  RuleBook rules_;
  Bounds bounds_;
  JunctionRule junction_;
  MoveBudget budget_;
  std::vector<Move> queue_, settled_, parts_;
  bool moving_ = false;    // there is a move before the next one
  size_t head_ = 0;        // first move of queue_ that is not settled
  size_t since_pass_ = 0;  // moves taken since the last pass
  double position_[kAxes] = {};
  std::vector<double> extruder_;
  double clock_ = 0, speed2_ = 0;
  double too_slow_ = 0;
  LimitId slowed_by_ = kFeedrate;

  void fill(Move& m, const MoveRequest& r);

  bool splits(const Move& m) const { return bounds_.nonlinear() && m.cartesian; }

  void enqueue(const Move& m, bool passes);

  void append(const Move& m, bool passes);

  // Sets the junction speed and the budget of the last move of the queue.
  void join(bool passes);

  // One backward and one forward pass. The start speed of a move that equals its own cap cannot
  // change any more, so all moves before it are final.
  void settle(bool flush);

  // Plans m from the current speed to at most `end2`: slower if the move is too short to
  // accelerate, faster if it is too short to brake (only after a replan).
  void trapezoid(Move& m, double end2);
};

}  // namespace passo
