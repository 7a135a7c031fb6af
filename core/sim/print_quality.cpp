#include "sim/print_quality.hpp"

#include <algorithm>
#include <cmath>

namespace passo::wire {

namespace {

constexpr double kQuietSeconds = 0.3;  // if there is no step for so long, measuring pauses
constexpr double kAheadMm =
    0.05;  // maximum jump of the place along the path, plus twice the motion
constexpr double kLeapFromMm =
    0.15;  // if the motors are farther from the path, they may have cut off a detour
constexpr double kLeapReach = 20;        // longest jump over a detour, per mm of that distance
constexpr double kLeapCost = 0.05;       // a jump of 1 mm counts as this distance from the path, mm
constexpr double kOnLineMm = 0.02;       // motors within this distance are on the line
constexpr double kStraight = 0.9994;     // cosine of the largest bend within a line
constexpr double kRelaxing = 5;          // number of time constants until the flow is steady
constexpr double kNearCornerMm = 1.0;    // distance from a corner within which rounding is measured
constexpr double kFarMm = 2.0;           // at this distance, the motors have lost the path
constexpr double kPastMm = 10;           // length of path behind the place that is kept
constexpr double kRecordSeconds = 0.15;  // duration of a picture after its corner
constexpr double kLastsSeconds = 0.1;    // minimum duration of a line for a picture
constexpr size_t kPast = 120;            // number of samples in a picture before its corner

double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
double distance(const double a[3], const double b[3]) {
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

// Distance of a point from the line between a and b.
double from_line(const double point[3], const double a[3], const double b[3]) {
  double d[3], p[3];
  for (int i = 0; i < 3; ++i) d[i] = b[i] - a[i], p[i] = point[i] - a[i];
  const double square = dot(d, d);
  const double share = square > 0 ? std::clamp(dot(p, d) / square, 0.0, 1.0) : 0;
  for (int i = 0; i < 3; ++i) p[i] -= share * d[i];
  return std::sqrt(dot(p, p));
}

}  // namespace

std::pair<double, double> PrintQuality::Segment::nearest(const double p[3], double least,
                                                         double most) const {
  double by[3], at[3];
  for (int i = 0; i < 3; ++i) by[i] = p[i] - from[i];
  const double mm = std::clamp(dot(by, unit), std::max(least, 0.0), std::min(most, length));
  for (int i = 0; i < 3; ++i) at[i] = from[i] + mm * unit[i];
  return {mm, distance(p, at)};
}

double PrintQuality::Spread::rms() const { return weight > 0 ? std::sqrt(square / weight) : 0; }

void PrintQuality::begin(double clock) {
  at_ = clock;
  head_->run(clock);
  stand();
}

void PrintQuality::add_path(const std::vector<PathSegment>& segments) {
  if (keeps_) kept_.insert(kept_.end(), segments.begin(), segments.end());
  for (const PathSegment& segment : segments) {
    Segment s{segment, distance(segment.from, segment.to), {}, 0};
    if (s.length <= 0) continue;
    if (!path_.empty()) s.begin = path_.back().begin + path_.back().length;
    for (int i = 0; i < 3; ++i) s.unit[i] = (s.to[i] - s.from[i]) / s.length;
    path_.push_back(s);
  }
}

void PrintQuality::run(double clock) {
  head_->take(clock);
  const double step = kSampleSeconds * hz_;
  while (at_ + step <= clock) {
    if (seconds(head_->last_step()) > kQuietSeconds && head_->next_step() > at_ + step) {
      at_ = std::min(clock, head_->next_step() - step / 2);
      head_->advance(at_);
      stand();
      continue;
    }
    at_ += step;
    head_->advance(at_);
    sample();
  }
}

void PrintQuality::finish() {
  end_rounding();
  end_ringing();
  end_recording();
}

void PrintQuality::stand() {
  for (int i = 0; i < 3; ++i) motors_[i] = head_->motor_mm(i), position_[i] = head_->mm(i);
  printed_ = false;
}

void PrintQuality::sample() {
  double motors[3], p[3];
  for (int i = 0; i < 3; ++i) motors[i] = head_->motor_mm(i), p[i] = head_->mm(i);
  if (!path_.empty()) {
    ++samples_;
    const double before_mm = path_[on_].begin + along_;
    follow(motors, distance(motors, motors_));
    if (off_ > kFarMm) {
      if (!over()) ++lost_;
      printed_ = false;
    } else {
      const double moved = distance(p, position_);
      const Segment& on = path_[on_];
      if (on.prints && on.begin + along_ > before_mm)
        off_path_.add(from_path(p, 2 * (off_ + distance(p, motors)) + kAheadMm), moved);
      const double width = measure_width(moved);
      round(position_, p);
      ring(p);
      record(p, width);
    }
  }
  std::copy_n(motors, 3, motors_);
  std::copy_n(p, 3, position_);
}

// Moves the place on the path to the point nearest to the motors. A filter may cut off a short
// detour; then the place jumps over it, which has a cost.
void PrintQuality::follow(const double motors[3], double moved) {
  const double near = 2 * moved + kAheadMm;
  const double reach = near + kLeapReach * std::max(0.0, off_ - kLeapFromMm);
  const double from = path_[on_].begin + along_;
  size_t best = on_;
  double best_mm = along_, least = kInfinity;
  for (size_t k = on_; k < path_.size() && path_[k].begin <= from + reach; ++k) {
    const Segment& s = path_[k];
    const auto [mm, off] = s.nearest(motors, from - s.begin, from + reach - s.begin);
    const double cost = off + kLeapCost * std::max(0.0, s.begin + mm - from - near);
    if (cost < least) least = cost, best = k, best_mm = mm, off_ = off;
  }
  while (on_ < best) next_segment();
  along_ = best_mm;
  while (on_ > 0 && path_[1].begin < path_[on_].begin - kPastMm) path_.pop_front(), --on_;
}

// Distance of a point from the path, within `reach` mm along the path on both sides of the place.
double PrintQuality::from_path(const double p[3], double reach) const {
  const double from = path_[on_].begin + along_;
  size_t k = on_;
  while (k > 0 && path_[k].begin > from - reach) --k;
  double least = kInfinity;
  for (; k < path_.size() && path_[k].begin <= from + reach; ++k) {
    const double begin = path_[k].begin;
    least = std::min(least, path_[k].nearest(p, from - reach - begin, from + reach - begin).second);
  }
  return least;
}

bool PrintQuality::ends() const { return path_[on_].length - along_ <= kOnLineMm; }

bool PrintQuality::over() const { return on_ + 1 == path_.size() && ends(); }

void PrintQuality::next_segment() {
  const Segment& before = path_[on_++];
  // After filament moved at standstill, the flow must become steady first: the measurement is about
  // lines, not about retraction.
  const Segment& after = path_[on_];
  if (after.after_filament && after.extruder < head_->nozzles())
    settled_at_ = at_ + kRelaxing * head_->nozzle(after.extruder).time_constant_s() * hz_;
  pass(before, after);
}

void PrintQuality::pass(const Segment& before, const Segment& after) {
  if (ringing_now_ &&
      after.unit[0] * ringing_now_->unit[0] + after.unit[1] * ringing_now_->unit[1] < kStraight)
    end_ringing();
  if (dot(before.unit, after.unit) > kSharp || !after.prints) return;
  if (std::hypot(after.unit[0], after.unit[1]) < kStraight) return;
  end_ringing();
  ringing_now_ = Ringing{{after.from[0], after.from[1]}, {after.unit[0], after.unit[1]}};
  if (!before.prints) return;
  ringing_now_->corner = corners_;
  end_recording();
  if (!wanted_ || *wanted_ == corners_) {
    recording_ = at_;
    recorded_ = {corners_,
                 after.line,
                 {after.from[0], after.from[1]},
                 {before.unit[0], before.unit[1]},
                 {after.unit[0], after.unit[1]},
                 0,
                 false,
                 {past_.begin(), past_.end()}};
  }
  if (rounding_now_) rounding_now_->left_at = at_;
  ++corners_;
}

// Measures the distance of the head's path from the last or the next corner.
void PrintQuality::round(const double from[3], const double to[3]) {
  if (rounding_now_ && rounding_now_->left_at >= 0 &&
      (along_ > kNearCornerMm || seconds(rounding_now_->left_at) > kRingingSeconds))
    end_rounding();
  const Segment& on = path_[on_];
  if (!rounding_now_ && on.prints && on.length - along_ < kNearCornerMm && on_ + 1 < path_.size()) {
    const Segment& next = path_[on_ + 1];
    if (next.prints && dot(on.unit, next.unit) <= kSharp &&
        std::hypot(next.unit[0], next.unit[1]) >= kStraight)
      rounding_now_ = Rounding{{on.to[0], on.to[1], on.to[2]}, kInfinity, -1};
  }
  if (rounding_now_)
    rounding_now_->nearest =
        std::min(rounding_now_->nearest, from_line(rounding_now_->at, from, to));
}

void PrintQuality::end_rounding() {
  if (rounding_now_ && rounding_now_->left_at >= 0) rounding_.add(rounding_now_->nearest, 1);
  rounding_now_.reset();
}

// Measures the deviation of the head across the line after a corner, from the time when the motors
// are on that line.
void PrintQuality::ring(const double p[3]) {
  if (!ringing_now_) return;
  Ringing& r = *ringing_now_;
  if (!path_[on_].prints) return end_ringing();
  auto across = [&r](double x, double y) {
    return (y - r.from[1]) * r.unit[0] - (x - r.from[0]) * r.unit[1];
  };
  const double motors = std::fabs(across(head_->motor_mm(0), head_->motor_mm(1)));
  if (r.settled < 0 && motors <= kOnLineMm) r.settled = at_;
  if (r.settled < 0) return;
  if (motors > 1.5 * kOnLineMm || seconds(r.settled) > kRingingSeconds) return end_ringing();
  const double off = std::fabs(across(p[0], p[1]));
  r.peak = std::max(r.peak, off);
  ringing_.add(off, 1);
}

void PrintQuality::end_ringing() {
  if (ringing_now_ && ringing_now_->corner == recorded_.number)
    recorded_.peak_mm = ringing_now_->peak;
  ringing_now_.reset();
}

// Width of the line between the last two samples, as a fraction of its nominal width; 0 without a
// line. Standstill at the end of a line, for a retraction, does not count.
double PrintQuality::measure_width(double moved) {
  const Segment& on = path_[on_];
  const bool ended = over() || (ends() && path_[on_ + 1].after_filament);
  const bool goes_on = printed_ && extruder_ == on.extruder && at_ >= settled_at_;
  printed_ = on.prints && !ended && on.extruder < head_->nozzles();
  if (!printed_) return 0;
  extruder_ = on.extruder;
  const double before = extruded_;
  extruded_ = head_->nozzle(on.extruder).extruded();
  if (!goes_on || moved <= 0) return 0;
  const double line_mm = (extruded_ - before) * on.length / on.filament_mm;
  width_error_mm_ += std::fabs(line_mm - moved);
  printed_mm_ += moved;
  return line_mm / moved;
}

void PrintQuality::record(const double p[3], double width) {
  const Segment& on = path_[on_];
  const double across = (p[1] - on.from[1]) * on.unit[0] - (p[0] - on.from[0]) * on.unit[1];
  Sample sample{0, {p[0], p[1]}, {head_->motor_mm(0), head_->motor_mm(1)}, across, width};
  sample.s = at_;  // a clock here; end_recording() converts it to seconds
  if (recording_ >= 0) {
    recorded_.samples.push_back(sample);
    if (seconds(recording_) >= kRecordSeconds) end_recording();
  }
  past_.push_back(sample);
  if (past_.size() > kPast) past_.pop_front();
}

void PrintQuality::end_recording() {
  if (recording_ < 0) return;
  if (ringing_now_ && ringing_now_->corner == recorded_.number)
    recorded_.peak_mm = ringing_now_->peak;
  recorded_.lasts = seconds(recording_) >= kLastsSeconds;
  if (wanted_ || shown_.samples.empty() || recorded_.shows_more(shown_)) {
    for (Sample& sample : recorded_.samples) sample.s = (sample.s - recording_) / hz_;
    shown_ = std::move(recorded_);
  }
  recorded_ = {};
  recording_ = -1;
}

}  // namespace passo::wire
