// Look-ahead on v² with constant acceleration. Moves go in, settled trapezoids come out; what is
// settled never depends on moves that follow, nor on how the input was cut.
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
  // A pass over the queue is made each time this many moves have come in.
  static constexpr size_t kBatch = 256;
  // Queue length at which the older half settles for a stop behind its end: counts moves, not time.
  static constexpr size_t kLongest = 8192;

  explicit Planner(const Machine& machine)
      : clock_hz_(machine.clock_hz), rules_(machine), bounds_(machine), junction_(machine),
        budget_(machine), extruder_(machine.extruders.size(), 0.0) {}

  // What holds for moves to come; those that came in before keep what held then.
  RuleBook& rules() { return rules_; }
  const RuleBook& rules() const { return rules_; }
  const Constraints& constraints() const { return *rules_.now().constraints; }
  double laser_share = 0;  // of full power, at the feed rate of moves to come

  // Settled moves that the caller has not taken yet; it clears the vector.
  std::vector<Move>& settled() { return settled_; }
  size_t queued() const { return queue_.size() - head_; }
  // Ticks that the queued moves take at least: at their nominal speeds, without acceleration.
  double queued_ticks() const;
  double clock() const { return clock_; }    // end of the last settled move, ticks
  double speed2() const { return speed2_; }  // its end speed, squared

  const double* position() const { return position_; }  // end of the last move pushed
  // Where the first queued move starts, or the next one will.
  const double* next_start() const { return queued() > 0 ? queue_[head_].p0 : position_; }
  double extruder_position(size_t i) const { return extruder_[i]; }
  // Sets where the next move starts, without motion. Only while nothing is queued.
  void set_position(const double* position, size_t extruder);
  // What comes later starts `mm` further along slot j. Only while nothing is queued.
  void move_end(int j, double mm) { position_[j] += mm; }
  // The settled plan ends at rest.
  bool rests() const { return speed2_ == 0; }
  // Time passes with the machine at rest. Only while the plan rests.
  void wait_until(double ticks);

  // Takes a move from where the last one ended, with `records` timed records due at its start.
  // False if it covers no distance and is dropped, or would take longer than kLongestMove: then
  // too_slow() says so.
  bool push(const MoveRequest& r, uint32_t records);

  // Seconds that the last move pushed would have taken, which was too long, and the limit that
  // bound its speed; 0: it was not.
  double too_slow() const { return too_slow_; }
  LimitId slowed_by() const { return slowed_by_; }

  // Settles all that is queued, for a stop at its end.
  void flush() { settle(true); }

  // Goes on at `clock` with speed² `speed2` in the midst of rest[0]: these moves, settled before,
  // and all that is queued are planned anew, each by its own rules. Where these ask for less speed
  // than the machine has, it brakes as the old plan could. Returns how many records were due at the
  // start of moves that are none any more, with no other behind them.
  uint32_t resume(std::vector<Move> rest, double speed2, double clock);

  // The plan is cut before `rest`, or else before what is queued: the board has its commands so
  // far.
  void rewind_budget(const std::vector<Move>& rest);

  // More records are due at the start of what is queued; false if nothing is.
  bool attach(uint32_t records);

  // Whether `allowed` holds for all that is queued.
  bool all_queued(const std::function<bool(const Move&)>& allowed) const;

  // Moves what is queued to the end of `rest`.
  void take_queue(std::vector<Move>& rest);

  // Shifts these moves, taken from the plan with all of its queue, see Shift; what comes later
  // starts beside where it would have.
  double shift(std::vector<Move>& moves, int j, double mm);

  // What comes later moves this extruder from where a change of its flow has put the filament.
  void place_filament(size_t extruder, const FlowChange& change);

  // Forgets the queue: the machine stands from `clock` on.
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

  // The last move of the queue has come behind those before it.
  void join(bool passes);

  // One backward and one forward pass. The start speed of a move that equals its own cap cannot
  // change any more, so all moves before it are final.
  void settle(bool flush);

  // From the speed that the machine has to at most `end2`; slower than that if the way is too short
  // to accelerate, faster if it is too short to brake (after a replan only).
  void trapezoid(Move& m, double end2);
};

}  // namespace passo
