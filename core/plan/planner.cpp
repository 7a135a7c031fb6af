#include "plan/planner.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>

namespace passo {

double Planner::queued_ticks() const {
  double seconds = 0;
  for (size_t i = head_; i < queue_.size(); ++i) {
    const Move& m = queue_[i];
    seconds += m.kind == MoveKind::dwell ? m.duration : m.d / std::sqrt(m.vn2);
  }
  return seconds * clock_hz_;
}

void Planner::set_position(const double* position, size_t extruder) {
  std::memcpy(position_, position, sizeof position_);
  if (extruder < extruder_.size()) extruder_[extruder] = position[kE];
}

void Planner::wait_until(double ticks) {
  budget_.rest(std::max(0.0, ticks - clock_) / clock_hz_);
  clock_ = std::max(clock_, ticks);
}

bool Planner::push(const MoveRequest& r, uint32_t records) {
  Move& m = queue_.emplace_back();
  fill(m, r);
  m.records = records;
  bool moves = bounds_.apply(m, rules_.now());
  constexpr double kLongest2 = kMaxMoveS * kMaxMoveS * (1 + 1e-9);  // beyond rounding
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

uint32_t Planner::resume(std::vector<Move> rest, double speed2, double clock) {
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

void Planner::rewind_budget(const std::vector<Move>& rest) {
  if (!rest.empty())
    budget_.set_ahead(rest[0].ahead0);
  else if (queued() > 0)
    budget_.set_ahead(queue_[head_].ahead0);
}

bool Planner::attach(uint32_t records) {
  if (queued() == 0) return false;
  queue_[head_].records = queue_[head_].records + records;
  return true;
}

bool Planner::all_queued(const std::function<bool(const Move&)>& allowed) const {
  return std::all_of(queue_.begin() + long(head_), queue_.end(), allowed);
}

void Planner::take_queue(std::vector<Move>& rest) {
  rest.insert(rest.end(), queue_.begin() + long(head_), queue_.end());
  stand(clock_);
}

double Planner::shift(std::vector<Move>& moves, int j, double mm) {
  double left = Shift(bounds_, junction_, rules_).apply(moves, j, mm);
  position_[j] += mm - left;
  return left;
}

void Planner::place_filament(size_t extruder, const FlowChange& change) {
  double before = extruder_[extruder];
  extruder_[extruder] = change.position(before);
  if (position_[kE] == before) position_[kE] = extruder_[extruder];
}

void Planner::stand(double clock) {
  queue_.clear();
  head_ = since_pass_ = 0;
  moving_ = false;
  speed2_ = 0;
  clock_ = clock;
}

inline void Planner::fill(Move& m, const MoveRequest& r) {
  static_cast<MoveOrigin&>(m) = r;
  std::memcpy(m.p0, position_, sizeof m.p0);
  std::memcpy(m.p1, r.target, sizeof m.p1);
  if (!extruder_.empty()) m.p0[kE] = extruder_[r.extruder];
  m.feed = r.feed_mm_s;
  m.duration = r.duration_s;
  m.fastest = r.fastest_mm_s;
  m.radius = r.radius_mm;
  m.arc_axis = r.arc_axis;
  m.from_faster = 0;
  m.advance = 0;
  const bool prints = r.kind == MoveKind::print && m.p1[kE] > m.p0[kE];
  if (prints && (m.p1[kX] != m.p0[kX] || m.p1[kY] != m.p0[kY]) && !advance.empty())
    m.advance = advance[r.extruder];
  m.flow = r.flow;
  m.owed = r.owed_mm;
  m.rules = rules_.use();
  m.unscaled = r.unscaled;
  m.kind = r.kind;
  m.moved = r.moved;
  m.inner = r.arc_inner;
  m.rapid = r.rapid;
  bool dark = r.rapid || r.kind == MoveKind::dwell || !(r.feed_mm_s < kInfinity);
  m.duty = r.beam > 0 ? r.beam : dark ? 0 : laser_share / r.feed_mm_s;
}

void Planner::enqueue(const Move& m, bool passes) {
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

void Planner::append(const Move& m, bool passes) {
  queue_.push_back(m);
  join(passes);
}

void Planner::join(bool passes) {
  Move& last = queue_.back();
  last.vj2 = 0;
  last.advance_binds = false;
  if (moving_) {
    const Move& before = queue_[queue_.size() - 2];
    const Rules& rules = rules_.of(last.rules);
    last.vj2 = junction_.cap2(before, last, rules);
    const double advance2 = junction_.advance_cap2(before, last, rules);
    last.advance_binds = advance2 < last.vj2;
    last.vj2 = std::min(last.vj2, advance2);
  }
  if (budget_.bounds_anything()) {
    if (!moving_) budget_.restart(speed2_);
    budget_.apply(last, moving_ ? last.vj2 : speed2_);
    last.vj2 = std::min(last.vj2, last.vn2);
  }
  moving_ = true;
  if (passes && ++since_pass_ == kBatch) settle(false);
}

void Planner::settle(bool flush) {
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
  if (!flush && end - final > kMaxQueued) final = head_ + (end - head_) / 2;
  for (; head_ < final; ++head_) {
    trapezoid(queue_[head_], head_ + 1 < end ? queue_[head_ + 1].v0 : 0);
    settled_.push_back(queue_[head_]);
  }
  if (head_ == end) {
    stand(clock_);  // also if the last braking distance was too short for a move
  } else if (head_ > 4 * kBatch) {
    queue_.erase(queue_.begin(), queue_.begin() + long(head_));
    head_ = 0;
  }
}

inline void Planner::trapezoid(Move& m, double end2) {
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
    // Only the old plan's braking distance may be left; it was within limits from here.
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
    const bool cruises = limits.minimum_cruise_ratio > 0;
    double room = cruises ? std::min(reach, 2 * m.cruise_a * m.d) : reach;
    double faster2 = std::max(start2, end2);
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

}  // namespace passo
