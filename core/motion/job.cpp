#include "motion/job.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "plan/extrusion_flow.hpp"

namespace passo {

Job::Job(const Machine& machine, std::vector<double> home, const LaserWords& laser, bool with_steps,
         double (*cpu_clock)())
    : motion(machine, with_steps, cpu_clock), interpreter(motion.machine(), std::move(home), laser),
      cpu_clock_(cpu_clock), reach_(motion.machine(), motion.planner(), interpreter),
      read_end_(motion.machine(), motion.planner()) {
  batch_.reserve(Planner::kBatch);
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
    ParseResult found = ParseResult::move;
    bool admitted = true;  // false: a move breaks a limit, and reading stops at its line
    batch_.clear();
    read_end_.take_plan_end();
    while (batch_.size() < Planner::kBatch && (found = interpreter.next()) == ParseResult::move) {
      batch_.push_back(interpreter.move());
      if (bounded) left -= read_end_.least_s(batch_.back()) * motion.machine().clock_hz;
      if (const auto first = lead_round(batch_.back())) {
        const MoveRequest rest = std::exchange(batch_.back(), *first);
        if (!(admitted = admit(batch_.back()))) break;
        batch_.push_back(rest);
      }
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
      case ParseResult::move:
        continue;
      case ParseResult::event:
        return Status::event;
      case ParseResult::macro:
        return Status::macro;
      case ParseResult::error:
        error_ = interpreter.error();
        return Status::error;
      case ParseResult::need_input:
        return Status::need_input;
      case ParseResult::end:
        return Status::end;
    }
  }
}

void Job::restart(uint32_t first_line) {
  // The program counts moves that were left out; the machine has not made them.
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
  m.rapid = true;     // the laser is off
  m.unscaled = true;  // homing and parking ignore M220
  read_end_.take_plan_end();
  if (read_end_.too_long(m, error_)) return false;
  const std::optional<MoveRequest> first = lead_round(m);
  const double* start = first ? first->target : read_end_.position();
  if ((within == Within::limits && !reach_.in_range(m)) ||
      (within != Within::anything &&
       ((first && !reach_.reaches(*first, read_end_.position())) || !reach_.reaches(m, start)))) {
    error_ = reach_.error();
    return false;
  }
  if ((first && !push(*first)) || !push(m)) return false;
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

double Job::change_flow_from(double ticks, size_t extruder, const FlowChange& change) {
  if (suspended_) {
    FlowChange suspended = change;
    motion.change_suspended_flow(extruder, suspended);
    suspended_->change_flow(extruder, suspended);
  }
  FlowChange planned = change;
  double cut = motion.change_flow_from(ticks, extruder, planned);
  interpreter.change_flow(extruder, planned);
  return cut;
}

double Job::scale_flow_from(double ticks, size_t extruder, double flow) {
  FlowChange change(flow * interpreter.width_factor(extruder));
  double cut = change_flow_from(ticks, extruder, change);
  if (suspended_) suspended_->set_flow(extruder, flow);
  interpreter.set_flow(extruder, flow);
  return cut;
}

double Job::scale_width_from(double ticks, size_t extruder, double width) {
  FlowChange change = FlowChange::by(width / interpreter.width_factor(extruder));
  double cut = change_flow_from(ticks, extruder, change);
  if (suspended_) suspended_->set_width_factor(extruder, width);
  interpreter.set_width_factor(extruder, width);
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

std::optional<MoveRequest> Job::lead_round(MoveRequest& m) const {
  const bool travels = m.kind != MoveKind::dwell && m.kind != MoveKind::extrude;
  const double* from = read_end_.position();
  double via[3], share;
  if (!travels || m.radius_mm < kInfinity || motion.machine().joints ||
      !motion.machine().geometry->leads_round(from, m.target, via, share))
    return std::nullopt;
  MoveRequest first = m;
  const double pushed = read_end_.filament_mm(m);
  for (int j = 0; j < kAxes; ++j) first.target[j] = from[j] + share * (m.target[j] - from[j]);
  std::copy_n(via, 3, first.target);
  first.target[kE] = m.target[kE] - (1 - share) * pushed;
  first.hop_mm = 0;
  for (double MoveRequest::* part : {&MoveRequest::duration_s, &MoveRequest::energy_ws}) {
    first.*part *= share;
    m.*part *= 1 - share;
  }
  if (m.flow > 0) m.owed_mm = owed_after(m.owed_mm, share * pushed);
  return first;
}

inline bool Job::admit(MoveRequest& m) {
  if (left_out.times > 0) read_end_.start_here(m);
  if (read_end_.too_long(m, error_)) {
    batch_.pop_back();
    return false;
  }
  if (!reach_.admits(m, read_end_.position())) {
    error_ = reach_.error();
    if (interpreter.clamp) leave_out(m);
    batch_.pop_back();
    return interpreter.clamp;
  }
  may_be_slow_ = read_end_.may_be_slow(m);
  read_end_.pass(m);
  return true;
}

void Job::leave_out(const MoveRequest& m) {
  if (left_out.times++ == 0) left_out.first = error_;
  const Machine& machine = motion.machine();
  for (size_t a = 3; a < machine.axes.size(); ++a) {
    int j = slot_of_axis(int(a));
    double mm = m.target[j] - read_end_.position()[j];
    if (machine.axes[a].filament && mm > 0) interpreter.shift(j, -mm);
  }
  // A retraction takes place with the next move.
  double mm = read_end_.filament_mm(m);
  if (mm > 0) interpreter.leave_filament(m.extruder, mm);
}

inline bool Job::push(const MoveRequest& m) {
  motion.push(m);
  const Planner& planner = motion.planner();
  if (planner.too_slow() == 0) return true;
  const std::string& limit = planner.constraints().names[planner.slowed_by()];
  error_ = {m.line, Fault::too_slow, limit, planner.too_slow(), kMaxMoveS, {0, 0, 0}};
  return false;
}

bool Job::may_shift(double ticks, int j, double mm) {
  if (interpreter.locked(j)) {
    error_ = {0, Fault::not_homed, motion.machine().axes[size_t(j)].name, 0, 0, {}};
    return false;
  }
  if (motion.allows_shift(ticks, j, mm,
                          [&](const double* p) { return reach_.reaches_shifted(p, j); }))
    return true;
  error_ = reach_.error();
  return false;
}

}  // namespace passo
