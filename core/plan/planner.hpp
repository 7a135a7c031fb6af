// Look-ahead on v² with constant acceleration. Moves go in, settled trapezoids come out; what is
// settled never depends on moves that follow, nor on how the input was cut.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstring>
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
  double queued_ticks() const {
    double seconds = 0;
    for (size_t i = head_; i < queue_.size(); ++i) {
      const Move& m = queue_[i];
      seconds += m.kind == MoveKind::dwell ? m.duration : m.d / std::sqrt(m.vn2);
    }
    return seconds * clock_hz_;
  }
  double clock() const { return clock_; }    // end of the last settled move, ticks
  double speed2() const { return speed2_; }  // its end speed, squared

  const double* position() const { return position_; }  // end of the last move pushed
  // Where the first queued move starts, or the next one will.
  const double* next_start() const { return queued() > 0 ? queue_[head_].p0 : position_; }
  double extruder_position(size_t i) const { return extruder_[i]; }
  // Sets where the next move starts, without motion. Only while nothing is queued.
  void set_position(const double* position, size_t extruder) {
    std::memcpy(position_, position, sizeof position_);
    if (extruder < extruder_.size()) extruder_[extruder] = position[kE];
  }
  // What comes later starts `mm` further along slot j. Only while nothing is queued.
  void move_end(int j, double mm) { position_[j] += mm; }
  // The settled plan ends at rest.
  bool rests() const { return speed2_ == 0; }
  // Time passes with the machine at rest. Only while the plan rests.
  void wait_until(double ticks) {
    budget_.rest(std::max(0.0, ticks - clock_) / clock_hz_);
    clock_ = std::max(clock_, ticks);
  }

  // Takes a move from where the last one ended, with `records` timed records due at its start.
  // False if it covers no distance and is dropped, or would take longer than kLongestMove: then
  // too_slow() says so.
  bool push(const MoveRequest& r, uint32_t records) {
    Move& m = queue_.emplace_back();
    fill(m, r);
    m.records = records;
    bool moves = bounds_.apply(m, rules_.now());
    constexpr double kLongest2 = kLongestMove * kLongestMove * (1 + 1e-9);  // beyond rounding
    bool slow = moves && m.d * m.d > kLongest2 * m.vn2;
    too_slow_ = slow ? m.d / std::sqrt(m.vn2) : 0;
    slowed_by_ = m.speed_limit;
    if (!moves || slow) {
      queue_.pop_back();
      return false;
    }
    std::memcpy(position_, m.p1, sizeof position_);
    if (!extruder_.empty()) extruder_[r.extruder] = m.p1[kE];
    if (splits(m)) {
      const Move whole = m;
      queue_.pop_back();
      enqueue(whole, true);
    } else {
      join(true);
    }
    return true;
  }

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
  uint32_t resume(std::vector<Move> rest, double speed2, double clock) {
    rest.insert(rest.end(), queue_.begin() + long(head_), queue_.end());
    stand(clock);
    speed2_ = speed2;
    uint32_t carried = 0;
    for (Move& m : rest) {
      double braking = m.b;
      m.records = m.records + carried;
      carried = m.records;
      if (!bounds_.apply(m, rules_.of(m.rules))) continue;
      carried = 0;
      m.b = std::max(m.b, braking);
      m.from_faster = braking;
      enqueue(m, false);
    }
    settle(false);
    return carried;
  }

  // The plan is cut before `rest`, or else before what is queued: the board has its commands so
  // far.
  void rewind_budget(const std::vector<Move>& rest) {
    if (!rest.empty())
      budget_.set_ahead(rest[0].ahead0);
    else if (queued() > 0)
      budget_.set_ahead(queue_[head_].ahead0);
  }

  // More records are due at the start of what is queued; false if nothing is.
  bool attach(uint32_t records) {
    if (queued() == 0) return false;
    queue_[head_].records = queue_[head_].records + records;
    return true;
  }

  // Whether `allowed` holds for all that is queued.
  bool all_queued(const std::function<bool(const Move&)>& allowed) const {
    return std::all_of(queue_.begin() + long(head_), queue_.end(), allowed);
  }

  // Moves what is queued to the end of `rest`.
  void take_queue(std::vector<Move>& rest) {
    rest.insert(rest.end(), queue_.begin() + long(head_), queue_.end());
    stand(clock_);
  }

  // Shifts these moves, taken from the plan with all of its queue, see Shift; what comes later
  // starts beside where it would have.
  double shift(std::vector<Move>& moves, int j, double mm) {
    double left = Shift(bounds_, junction_, rules_).apply(moves, j, mm);
    position_[j] += mm - left;
    return left;
  }

  // What comes later moves this extruder from where a change of its flow has put the filament.
  void place_filament(size_t extruder, const FlowChange& change) {
    double before = extruder_[extruder];
    extruder_[extruder] = change.place(before);
    if (position_[kE] == before) position_[kE] = extruder_[extruder];
  }

  // Forgets the queue: the machine stands from `clock` on.
  void stand(double clock) {
    queue_.clear();
    head_ = since_pass_ = 0;
    moving_ = false;
    speed2_ = 0;
    clock_ = clock;
  }

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

  void fill(Move& m, const MoveRequest& r) {
    std::memcpy(m.p0, position_, sizeof m.p0);
    std::memcpy(m.p1, r.target, sizeof m.p1);
    if (!extruder_.empty()) m.p0[kE] = extruder_[r.extruder];
    m.feed = r.feed_mm_s;
    m.duration = r.duration_s;
    m.fastest = r.fastest_mm_s;
    m.radius = r.radius_mm;
    m.arc_axis = r.arc_axis;
    m.from_faster = 0;
    m.flow = r.flow;
    m.owed = r.owed_mm;
    m.rules = rules_.use();
    m.unscaled = r.unscaled;
    m.line = r.line;
    m.main_line = r.main_line;
    m.layer = r.layer;
    m.feature = r.feature;
    m.extruder = r.extruder;
    m.tool = r.tool;
    m.kind = r.kind;
    m.moved = r.moved;
    m.inner = r.arc_inner;
    m.rapid = r.rapid;
    bool dark = r.rapid || r.kind == MoveKind::dwell || !(r.feed_mm_s < kInfinity);
    m.duty = r.beam > 0 ? r.beam : dark ? 0 : laser_share / r.feed_mm_s;
  }

  bool splits(const Move& m) const { return bounds_.nonlinear() && m.cartesian; }

  void enqueue(const Move& m, bool passes) {
    if (!splits(m)) {
      append(m, passes);
      return;
    }
    bounds_.split(m, rules_.of(m.rules), parts_);
    for (size_t i = 0; i < parts_.size(); ++i) {
      if (i > 0) parts_[i].records = 0;
      append(parts_[i], passes);
    }
  }

  void append(const Move& m, bool passes) {
    queue_.push_back(m);
    join(passes);
  }

  // The last move of the queue has come behind those before it.
  void join(bool passes) {
    Move& last = queue_.back();
    last.vj2 = moving_ ? junction_.cap2(queue_[queue_.size() - 2], last, rules_.of(last.rules)) : 0;
    if (budget_.bounds_anything()) {
      if (!moving_) budget_.restart(speed2_);
      budget_.apply(last, moving_ ? last.vj2 : speed2_);
      last.vj2 = std::min(last.vj2, last.vn2);
    }
    moving_ = true;
    if (passes && ++since_pass_ == kBatch) settle(false);
  }

  // One backward and one forward pass. The start speed of a move that equals its own cap cannot
  // change any more, so all moves before it are final.
  void settle(bool flush) {
    since_pass_ = 0;
    size_t end = queue_.size(), final = flush ? end : head_;
    double v2 = 0;
    for (size_t i = end; i-- > head_;) {
      Move& m = queue_[i];
      double reachable = v2 + 2 * m.a * m.d;
      bool capped = reachable >= m.vj2;
      v2 = capped ? m.vj2 : reachable;
      m.v0 = v2;
      if (capped && !flush && final == head_) final = i;
    }
    if (!flush && end - final > kLongest) final = head_ + (end - head_) / 2;
    for (; head_ < final; ++head_) {
      trapezoid(queue_[head_], head_ + 1 < end ? queue_[head_ + 1].v0 : 0);
      settled_.push_back(queue_[head_]);
    }
    if (head_ == end) {
      stand(clock_);  // where the last way to brake was too short to be a move, too
    } else if (head_ > 4 * kBatch) {
      queue_.erase(queue_.begin(), queue_.begin() + long(head_));
      head_ = 0;
    }
  }

  // From the speed that the machine has to at most `end2`; slower than that if the way is too short
  // to accelerate, faster if it is too short to brake (after a replan only).
  void trapezoid(Move& m, double end2) {
    double start2 = speed2_, reach = 2 * m.a * m.d;
    m.start = clock_;
    end2 = std::min(end2, start2 + reach);
    if (m.kind == MoveKind::dwell) {
      m.v0 = m.vc = m.v1 = m.d_acc = m.d_cru = m.t_acc = m.t_dec = 0;
      m.t_cru = m.duration * clock_hz_;
      clock_ += m.t_cru;
      return;
    }
    // The bends of nonlinear axes take more of their acceleration at a higher speed.
    bool faster = start2 > m.vn2 * (1 + 1e-9) && m.from_faster > 0;
    double hardest = faster ? m.from_faster : m.b, braking = std::min(m.a, hardest);
    if (start2 - end2 > 2 * braking * m.d) {
      // The old plan's way to brake may be all that is left, and was within limits from here.
      hardest = std::max(hardest, m.from_faster);
      braking = std::min(hardest, (start2 - end2) / (2 * m.d));
      double least2 = start2 - 2 * braking * m.d;
      if (least2 > end2 + 1e-9 * start2 + 1e-10)
        end2 = least2;  // beyond rounding: cannot brake that hard
    }
    double peak2;
    if (start2 > m.vn2) {  // too fast already: brake to the nominal speed first
      peak2 = std::max(m.vn2, end2);
      m.d_acc = std::min((start2 - peak2) / (2 * braking), m.d);
      m.a = -braking;
    } else {
      const Limits& limits = rules_.of(m.rules).limits;
      double room = reach * (1 - limits.minimum_cruise_ratio), faster2 = std::max(start2, end2);
      double gain = 1 + limits.least_speed_gain;
      peak2 = std::max(std::min(m.vn2, 0.5 * (start2 + end2 + room)), faster2);
      if (peak2 < gain * gain * faster2) peak2 = faster2;
      m.d_acc = std::min((peak2 - start2) / (2 * m.a), m.d);
    }
    m.b = braking;
    double d_dec = std::min((peak2 - end2) / (2 * m.b), m.d - m.d_acc);
    m.d_cru = m.d - m.d_acc - d_dec;
    m.v0 = std::sqrt(start2);
    m.vc = std::sqrt(peak2);
    m.v1 = std::sqrt(end2);
    m.t_acc = (m.vc - m.v0) / m.a * clock_hz_;
    m.t_cru = m.d_cru / m.vc * clock_hz_;
    m.t_dec = (m.vc - m.v1) / m.b * clock_hz_;
    clock_ = m.start + m.ticks();
    speed2_ = end2;
  }
};

}  // namespace passo
