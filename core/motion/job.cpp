#include "motion/job.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "geometry/line_sampling.hpp"

namespace passo {

Job::Job(const Machine& machine, std::vector<double> home, const LaserWords& laser, bool with_steps,
         double (*cpu_clock)())
    : motion(machine, with_steps, cpu_clock), interpreter(motion.machine(), std::move(home), laser),
      cpu_clock_(cpu_clock) {
  batch_.reserve(Planner::kBatch);
  extruders_at_.resize(motion.machine().extruders.size());
  motion.set_position(interpreter.position(), interpreter.extruder());
}

Job::Status Job::advance(double horizon, size_t most, bool to_boundary) {
  const bool bounded = horizon < kInfinity;
  for (;;) {
    double left = horizon;
    if (bounded) left -= motion.planner().clock() + motion.planner().queued_ticks();
    if (to_boundary ? interpreter.at_boundary() : left <= 0 || motion.stream().waiting() >= most)
      return Status::full;
    double start = now();
    Found found = Found::move;
    bool admitted = true;  // an error in a move stops the reading at its line
    batch_.clear();
    begin_at_the_end();
    while (batch_.size() < Planner::kBatch && (found = interpreter.next()) == Found::move) {
      batch_.push_back(interpreter.move());
      if (bounded) left -= least_s(batch_.back()) * motion.machine().clock_hz;
      if (!(admitted = admit(batch_.back())) || may_be_slow_ || left <= 0) break;
      if (to_boundary && interpreter.at_boundary()) break;
    }
    double parsed = now();
    cpu_parse += parsed - start;
    double before = motion.cpu().steps + motion.cpu().compress;
    for (size_t i = 0; i < batch_.size(); ++i)
      if (!push(batch_[i])) {
        admitted = false;
        break;
      }
    cpu_plan += now() - parsed - (motion.cpu().steps + motion.cpu().compress - before);
    if (!admitted) return Status::error;
    switch (found) {
      case Found::move:
        continue;
      case Found::event:
        return Status::event;
      case Found::macro:
        return Status::macro;
      case Found::error:
        error_ = interpreter.error();
        return Status::error;
      case Found::need_input:
        return Status::need_input;
      case Found::end:
        return Status::end;
    }
  }
}

void Job::restart(uint32_t first_line) {
  // The program counts moves that were left out among its positions; the machine does not.
  if (std::exchange(left_out, {}).times > 0) abandon();
  interpreter.restart(first_line);
}

void Job::abandon() {
  std::vector<double> extruders;
  for (size_t i = 0; i < motion.machine().extruders.size(); ++i)
    extruders.push_back(motion.planner().extruder_position(i));
  interpreter.abandon(motion.planner().position(), extruders);
}

double Job::stop_from(double ticks, bool program) {
  double cut = motion.hold_from(ticks);
  use_stopped();
  motion.forget_held();
  interpreter.dark();
  if (program) interpreter.forget_retraction();
  abandon();
  return cut;
}

void Job::suspend(bool hand_over) {
  suspended_ = interpreter;
  if (hand_over) suspended_->hand_over_macro(interpreter);
  use_stopped();
  motion.suspend();
  abandon();
}

void Job::resume() {
  interpreter.resume(*suspended_);
  suspended_.reset();
  motion.resume();
}

void Job::set_tool_offset(size_t tool, int axis, double mm) {
  if (tool == interpreter.tool()) interpreter.shift_tool(axis, mm);
  if (suspended_ && tool == suspended_->tool()) suspended_->shift_tool(axis, mm);
  motion.set_tool_offset(tool, axis, mm);
}

bool Job::move_to(const double* target, double feed_mm_s, Within within) {
  MoveRequest m{};
  const auto from = position();
  std::copy(from.begin(), from.end(), m.target);
  bool travels = false;
  for (int j = 0; j < kAxes; ++j) {
    if (std::isnan(target[j])) continue;
    m.target[j] = target[j];
    if (target[j] != from[size_t(j)]) m.moved |= uint8_t(1u << j);
    travels |= j != kE && target[j] != from[size_t(j)];
  }
  m.kind = travels ? MoveKind::travel : MoveKind::extrude;
  m.extruder = uint16_t(interpreter.extruder());
  m.tool = uint16_t(interpreter.tool());
  m.feed_mm_s = feed_mm_s;
  m.radius_mm = kInfinity;
  m.rapid = true;     // no laser burns on it
  m.unscaled = true;  // homing, parking: at the speed of the machine file
  begin_at_the_end();
  if (too_long(m) || (within == Within::limits && !in_range(m))) return false;
  bool reaches = within != Within::anything && motion.planner().constraints().checks_reach();
  if (reaches && !reach(m)) return false;
  if (!push(m)) return false;
  abandon();
  return true;
}

std::optional<double> Job::shift_from(double ticks, int j, double mm) {
  if (!may_shift(ticks, j, mm)) return std::nullopt;
  double cut = motion.shift_from(ticks, j, mm, interpreter.extruder(), interpreter.tool());
  if (suspended_) {
    suspended_->shift(j, mm);
    interpreter.shift_zero(j, mm);
  } else {
    interpreter.shift(j, mm);
  }
  return cut;
}

bool Job::shift(int j, double mm) {
  if (!may_shift(kInfinity, j, mm)) return false;
  motion.push_shift(j, mm, interpreter.extruder(), interpreter.tool());
  interpreter.shift(j, mm);
  return true;
}

void Job::absorb_shift(int j, double mm) {
  interpreter.absorb_shift(j, mm);
  if (!suspended_) return;
  suspended_->shift(j, -mm);
  motion.shift_suspended(j, -mm);
}

double Job::scale_flow_from(double ticks, size_t extruder, double flow) {
  if (suspended_) {
    FlowChange change(flow);
    motion.change_suspended_flow(extruder, change);
    suspended_->change_flow(extruder, change);
  }
  FlowChange change(flow);
  double cut = motion.change_flow_from(ticks, extruder, change);
  interpreter.change_flow(extruder, change);
  return cut;
}

void Job::adopt(Job& other) {
  motion.flush();
  interpreter.adopt(other.interpreter);
  if (bed_) use_bed();
  Planner &mine = motion.planner(), &theirs = other.motion.planner();
  mine.rules().change(false, [&](Rules& rules) {
    rules.limits = theirs.rules().now().limits;
    rules.constraints = theirs.rules().now().constraints;
  });
  double position[kAxes];
  std::copy_n(interpreter.position(), kAxes, position);
  for (size_t i = 0; i < motion.machine().extruders.size(); ++i) {
    position[kE] = theirs.extruder_position(i);
    motion.set_position(position, i);
  }
  motion.set_position(interpreter.position(), interpreter.extruder());
}

void Job::settle_position() {
  motion.flush();
  motion.set_position(interpreter.position(), interpreter.extruder());
}

void Job::set_height_map(std::shared_ptr<const HeightMap> map) {
  motion.flush();
  bed_ = std::move(map);
  use_bed();
  interpreter.set_place(kZ, motion.planner().position()[kZ]);
}

void Job::follow_tool() {
  if (!bed_is_apart()) return;
  motion.flush();
  use_bed();
  interpreter.put(kZ, motion.planner().position()[kZ]);
}

std::array<double, 2> Job::tool_offset() const {
  const std::vector<Tool>& tools = motion.machine().tools;
  if (tools.empty()) return {};
  const Tool& tool = tools[interpreter.tool()];
  return {tool.offset[kX], tool.offset[kY]};
}

void Job::use_bed() {
  map_offset_ = tool_offset();
  const auto [x, y] = map_offset_;
  const bool apart = bed_ && (x != 0 || y != 0);
  motion.set_height_map(apart ? std::make_shared<HeightMap>(bed_->moved(-x, -y)) : bed_);
}

void Job::use_stopped() {
  const auto tool = motion.stopped_tool();
  if (!tool) return;
  interpreter.take_tool(*tool);
  interpreter.forget_offset();
}

void Job::begin_at_the_end() {
  std::copy_n(motion.planner().position(), kAxes, at_);
  for (size_t i = 0; i < extruders_at_.size(); ++i)
    extruders_at_[i] = motion.planner().extruder_position(i);
  const Constraints& constraints = motion.planner().constraints();
  slowest_mm_s_ = motion.planner().rules().now().limits.speed;
  for (const Row& row : constraints.rows) slowest_mm_s_ = std::min(slowest_mm_s_, row.speed);
  for (const Row& row : constraints.extruders) slowest_mm_s_ = std::min(slowest_mm_s_, row.speed);
}

inline bool Job::admit(MoveRequest& m) {
  // If a move before it was left out, filament alone moves nothing else, and a dwell nothing.
  if (left_out.times > 0 && m.kind == MoveKind::extrude) std::copy_n(at_, 3, m.target);
  if (left_out.times > 0 && m.kind == MoveKind::dwell) {
    std::copy_n(at_, kAxes, m.target);
    if (!extruders_at_.empty()) m.target[kE] = extruders_at_[m.extruder];
  }
  bool travels = m.kind != MoveKind::dwell && m.kind != MoveKind::extrude;
  bool sound = !too_long(m);
  if (sound && travels && motion.planner().constraints().checks_reach() && !reach_all(m) &&
      !(m.hop_mm > 0 && reach_without_hop(m))) {
    sound = interpreter.clamp;
    if (sound) {
      if (left_out.times++ == 0) left_out.first = error_;
      leave_filament(m);
      batch_.pop_back();
      return true;
    }
  }
  if (!sound) {
    batch_.pop_back();
    return false;
  }
  may_be_slow_ = slow(m);
  std::copy_n(m.target, kAxes, at_);
  if (!extruders_at_.empty()) extruders_at_[m.extruder] = m.target[kE];
  return true;
}

bool Job::reach_without_hop(MoveRequest& m) {
  const double mm = std::exchange(m.hop_mm, 0);
  m.target[kZ] -= mm;
  interpreter.drop_hop(mm);
  return reach_all(m);
}

bool Job::reach_all(const MoveRequest& m) {
  const Arc& arc = interpreter.arc();
  if (m.radius_mm < kInfinity && arc.reached()) return true;
  if (!reach(m)) return false;
  if (interpreter.clamp || !arc.active()) return true;
  double from[kAxes], to[kAxes];
  std::copy_n(m.target, kAxes, from);
  for (Arc rest = arc; rest.active(); std::copy_n(to, kAxes, from)) {
    interpreter.take_chord(rest, to);
    if (!reach(from, to, m.line)) return false;
  }
  interpreter.note_arc_reached();
  return true;
}

double Job::distance_mm(const MoveRequest& m) const {
  double mm = 0;
  for (int j = 0; j < kAxes; ++j)
    if (j != kE) mm += std::fabs(m.target[j] - at_[j]);
  if (!extruders_at_.empty()) mm += std::fabs(m.target[kE] - extruders_at_[m.extruder]);
  return mm;
}

double Job::least_s(const MoveRequest& m) {
  double mm_s = 0;
  for (const Row& row : motion.planner().constraints().rows) mm_s += row.speed;
  return std::max(m.duration_s, distance_mm(m) / std::min(m.feed_mm_s, mm_s));
}

bool Job::slow(const MoveRequest& m) const {
  const double mm = distance_mm(m);
  return m.duration_s > kQuickS || mm > kQuickS * m.feed_mm_s || mm > kQuickS * slowest_mm_s_;
}

inline bool Job::push(const MoveRequest& m) {
  motion.push(m);
  const Planner& planner = motion.planner();
  if (planner.too_slow() == 0) return true;
  const std::string& limit = planner.constraints().names[planner.slowed_by()];
  error_ = {m.line, Fault::too_slow, limit, planner.too_slow(), kMaxMoveS, {0, 0, 0}};
  return false;
}

inline bool Job::too_long(const MoveRequest& m) {
  const Machine& machine = motion.machine();
  if (m.kind == MoveKind::dwell) return false;
  auto beyond = [&](double from, double to, const std::string& name) {
    double mm = to - from;
    if (std::fabs(mm) <= kMaxFilamentMm) return false;
    error_ = {m.line, Fault::too_long, name, mm, kMaxFilamentMm, {0, 0, 0}};
    return true;
  };
  for (size_t a = 3; a < machine.axes.size(); ++a) {
    int j = slot_of_axis(int(a));
    if (machine.axes[a].filament && beyond(at_[j], m.target[j], machine.axes[a].name)) return true;
  }
  return !machine.extruders.empty() &&
         beyond(extruders_at_[m.extruder], m.target[kE], machine.extruders[m.extruder].name);
}

bool Job::in_range(const MoveRequest& m) {
  for (int j = 0; j < kAxes; ++j)
    if ((m.moved >> j & 1) && !interpreter.in_range(j, m.target[j], error_)) return false;
  return true;
}

void Job::leave_filament(const MoveRequest& m) {
  const Machine& machine = motion.machine();
  for (size_t a = 3; a < machine.axes.size(); ++a) {
    int j = slot_of_axis(int(a));
    double mm = m.target[j] - at_[j];
    if (machine.axes[a].filament && mm > 0) interpreter.shift(j, -mm);
  }
  if (machine.extruders.empty()) return;
  double mm = m.target[kE] - extruders_at_[m.extruder];
  if (mm > 0) interpreter.leave_filament(m.extruder, mm);  // a retraction is made up for
}

bool Job::reach(const MoveRequest& m) { return reach(at_, m.target, m.line); }

bool Job::reach(const double* from, const double* to, uint32_t line) {
  const Geometry& geometry = *motion.machine().geometry;
  double mm = 0, p[3];
  for (int j = 0; j < 3; ++j) mm += (to[j] - from[j]) * (to[j] - from[j]);
  mm = std::sqrt(mm);
  int n = std::min(1 + int(mm / kCheckEvery), 4096);
  const Sampling sampling(geometry, from, to, mm, n);
  auto reaches = [&](double at) {
    for (int j = 0; j < 3; ++j) p[j] = from[j] + (to[j] - from[j]) * at;
    return reach_point(p, line, from);
  };
  for (int i = 1; i <= n; ++i) {
    if (!sampling.before(i, reaches)) return false;
    for (int j = 0; j < 3; ++j) p[j] = i == n ? to[j] : from[j] + (to[j] - from[j]) * i / n;
    if (!reach_point(p, line, from)) return false;
  }
  return !geometry.jumps(from, to) || stop_at_jump(from, to, line);
}

bool Job::stop_at_jump(const double* from, const double* to, uint32_t line) {
  double low = 0, high = 1, p[3];
  for (int k = 0; k < 48; ++k) {
    double middle = 0.5 * (low + high);
    for (int j = 0; j < 3; ++j) p[j] = from[j] + (to[j] - from[j]) * middle;
    (motion.machine().geometry->jumps(from, p) ? high : low) = middle;
  }
  error_ = {line, Fault::unreachable, "", 0, 0, {p[0], p[1], p[2]}};
  return false;
}

bool Job::reach_point(const double* p, uint32_t line, const double* from) {
  const Machine& machine = motion.machine();
  for (const StepperSpec& s : machine.steppers) {
    if (s.drive != Drive::actuator) continue;
    double q = machine.geometry->inverse(s.index, p);
    double half_step = 0.5 / s.steps_per_unit;  // so far the nearest step may lie beyond
    if (q >= s.min - half_step && q <= s.max + half_step) continue;
    double start = from == nullptr ? q : machine.geometry->inverse(s.index, from);
    if (q < s.min ? q > start : q < start) continue;
    double home = machine.geometry->inverse(s.index, interpreter.homed());
    if (q < s.min ? q >= home - half_step : q <= home + half_step) continue;
    bool nowhere = !(std::fabs(q) < 1e12);
    error_ = {line,
              nowhere ? Fault::unreachable : Fault::actuator,
              nowhere ? "" : s.name,
              nowhere ? 0 : q,
              q < s.min ? s.min : s.max,
              {p[0], p[1], p[2]}};
    return false;
  }
  return true;
}

bool Job::may_shift(double ticks, int j, double mm) {
  if (interpreter.locked(j)) {
    error_ = {0, Fault::not_homed, motion.machine().axes[size_t(j)].name, 0, 0, {}};
    return false;
  }
  bool reaches = motion.planner().constraints().checks_reach();
  return motion.allows_shift(ticks, j, mm, [&](const double* p) {
    return interpreter.in_range(j, p[j], error_) && (!reaches || reach_point(p, 0));
  });
}

}  // namespace passo
