#include "motion/motion.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <stdexcept>

#include "motion/stopping.hpp"
#include "plan/braking.hpp"

namespace passo {

Motion::Motion(const Machine& machine, bool with_steps, double (*cpu_clock)())
    : machine_(machine), planner_(machine_), with_steps_(with_steps), cpu_clock_(cpu_clock),
      stream_(machine_, with_steps,
              [this](int64_t clock, std::vector<Move>& past, std::vector<Move>& moves) {
                brake_from(clock, history_, planner_, machine_.clock_hz, moves);
                if (memory() > 0) past = history_.before(double(clock), memory());
              }),
      history_(machine_.clock_hz), lines_(machine_.clock_hz) {
  plan_.filament_mm.resize(machine_.extruders.size());
}

void Motion::push(const MoveRequest& request) {
  if (std::exchange(in_pieces_, false)) flush();
  if (planner_.push(request, unattached_)) unattached_ = 0;
  if (!planner_.settled().empty()) process(false);
}

void Motion::add_pieces(std::vector<Piece> pieces) {
  if (stream_.commits()) throw std::invalid_argument("pieces cannot be stopped on their way");
  if (!in_pieces_) flush();
  bool filament = !pieces.empty() && pieces[0].extruder < machine_.extruders.size();
  check_pieces(machine_, pieces, planner_.position(),
               filament ? planner_.extruder_position(pieces[0].extruder) : 0);
  for (Piece& p : pieces) {
    in_pieces_ = true;
    p.start = planner_.clock();
    plan_.add(p);
    stream_.solve(p);
    planner_.wait_until(p.start + p.seconds * machine_.clock_hz);
    planner_.set_position(p.end, p.extruder);
    pieces_end_ = planner_.clock();
  }
  process(false);
}

void Motion::record(uint16_t target, uint32_t value) {
  auto near = records_.rbegin() + std::min<long>(unattached_, kOutputsSeen);
  auto same =
      std::find_if(records_.rbegin(), near, [=](const Record& r) { return r.target == target; });
  if (target < kMark && same != near) {
    same->value = value;  // the earlier value would have no effect
    return;
  }
  records_.push_back({target, value, 0});
  ++unattached_;
  if (planner_.queued() == 0) place_at_end();
}

void Motion::record_at(double ticks, uint16_t target, uint32_t value) {
  auto held = stream_.hold();
  stream_.set_output_among(target, value, ticks);
  merge(false);
}

void Motion::flush() {
  in_pieces_ = false;
  planner_.flush();
  process(true);
}

void Motion::set_position(const double* position, size_t extruder, unsigned found) {
  planner_.set_position(position, extruder);
  for (size_t i = 0; i < stream_.motors(); ++i) {
    const StepperSpec& s = machine_.steppers[i];
    if (s.drive == Drive::actuator && s.index < 3 && (found >> s.index & 1)) stream_.lean(i);
    if (s.drive != Drive::extruder || size_t(s.index) == extruder)
      stream_.set_position(i, position);
  }
}

std::array<double, kAxes> Motion::position(size_t extruder) const {
  std::array<double, kAxes> p;
  std::copy_n(planner_.position(), kAxes, p.begin());
  if (extruder < machine_.extruders.size()) p[kE] = planner_.extruder_position(extruder);
  return p;
}

void Motion::set_steps_per_unit(size_t i, double value) {
  StepperSpec& s = machine_.steppers[i];
  const Constraints before(machine_);
  s.steps_per_unit = value;
  planner_.rules().change(false, [&](Rules& r) {
    r.constraints = std::make_shared<Constraints>(r.constraints->rescaled(before, machine_));
  });
  bool own = s.drive == Drive::extruder;
  const auto p = position(own ? size_t(s.index) : machine_.extruders.size());
  stream_.use_gaps();
  if (i < stream_.motors()) stream_.set_position(i, p.data());
}

void Motion::set_height_map(std::shared_ptr<const HeightMap> map) {
  double position[kAxes];
  std::copy_n(planner_.position(), kAxes, position);
  double height = machine_.raised(position);
  machine_.height_map = std::move(map);
  position[kZ] = machine_.plan_z(position[kX], position[kY], height);
  planner_.set_position(position, machine_.extruders.size());
}

void Motion::set_geometry(std::shared_ptr<const Geometry> geometry) {
  const Constraints before(machine_);
  machine_.geometry = std::move(geometry);
  stream_.use_geometry();
  planner_.use_geometry();
  planner_.rules().change(false, [&](Rules& r) {
    r.constraints = std::make_shared<Constraints>(r.constraints->rescaled(before, machine_));
  });
}

void Motion::let_rest(const std::vector<size_t>& motors) {
  for (size_t i = 0; i < stream_.motors(); ++i)
    stream_.let_rest(i, std::find(motors.begin(), motors.end(), i) != motors.end());
}

void Motion::use_commits(int64_t period, size_t most) {
  stream_.use_commits(period, most, int64_t(std::ceil(planner_.clock())));
}

std::optional<double> Motion::recover_from(uint32_t serial) {
  auto held = stream_.hold();
  std::optional<Commits::Point> commit = stream_.rewind(serial);
  if (!commit) return std::nullopt;
  hold_from(double(commit->clock), commit->stop_distance);
  std::deque<Record> late;
  for (const Message& m : stream_.resume_at_rest(serial, int64_t(std::ceil(planner_.clock()))))
    if (m.target != laser_.target()) late.push_back({m.target, m.interval, m.clock});
  held_.record_first(late);
  return double(commit->clock);
}

double Motion::replan_from(double ticks) {
  std::vector<Move> rest;
  double speed2 = cut(ticks, rest);
  continue_plan(rest, speed2);
  return ticks_of_cut_;
}

double Motion::shift_from(double ticks, int j, double mm, size_t extruder, size_t tool) {
  if (suspended_) {
    shift_suspended(j, mm);
    return planner_.clock();
  }
  if (held() > 0) {
    held_.shift_from_rest(j, mm);
    planner_.move_end(j, mm);
    return planner_.clock();
  }
  double left = 0;
  change_from(ticks, [&](std::vector<Move>& rest) { left = planner_.shift(rest, j, mm); });
  if (left != 0) push_shift(j, left, extruder, tool);
  return ticks_of_cut_;
}

void Motion::shift_suspended(int j, double mm) {
  suspended_->held.shift(j, mm);
  suspended_->stop[j] += mm;
  suspended_->end[j] += mm;
}

void Motion::push_shift(int j, double mm, size_t extruder, size_t tool) {
  MoveRequest m{};
  std::copy_n(planner_.position(), kAxes, m.target);
  m.target[j] += mm;
  if (extruder < machine_.extruders.size()) m.target[kE] = planner_.extruder_position(extruder);
  m.extruder = uint16_t(extruder);
  m.tool = uint16_t(tool);
  m.feed_mm_s = m.radius_mm = kInfinity;
  m.kind = MoveKind::travel;
  m.moved = uint8_t(1u << j);
  push(m);
}

double Motion::change_flow_from(double ticks, size_t extruder, FlowChange& change) {
  if (held() > 0) {
    change_flow(held_.moves, extruder, change);
    planner_.place_filament(extruder, change);
    return planner_.clock();
  }
  change_from(ticks, [&](std::vector<Move>& rest) {
    change_flow(rest, extruder, change);
    planner_.place_filament(extruder, change);
  });
  return ticks_of_cut_;
}

void Motion::change_suspended_flow(size_t extruder, FlowChange& change) {
  change_flow(suspended_->held.moves, extruder, change);
  double& end = suspended_->extruders[extruder];
  if (suspended_->end[kE] == end) suspended_->end[kE] = change.position(end);
  end = change.position(end);
}

bool Motion::allows_shift(double ticks, int j, double mm,
                          const std::function<bool(const double*)>& allowed) const {
  auto allowed_at = [&](const double* end) {
    double p[kAxes];
    std::copy_n(end, kAxes, p);
    p[j] += mm;
    return allowed(p);
  };
  auto ends = [&](const Move& m) { return allowed_at(m.p1); };
  if (ticks == kInfinity && !suspended_) return allowed_at(planner_.position());
  if (suspended_)
    return allowed_at(suspended_->stop) && allowed_at(suspended_->end) &&
           std::all_of(suspended_->held.moves.begin(), suspended_->held.moves.end(), ends);
  if (held() > 0)
    return allowed_at(held_.moves.front().p0) && allowed_at(planner_.position()) &&
           std::all_of(held_.moves.begin(), held_.moves.end(), ends);
  return std::all_of(history_.at(ticks), history_.end(), ends) && planner_.all_queued(ends) &&
         allowed_at(planner_.position());
}

std::optional<double> Motion::skip_dwell_from(double ticks) {
  auto m = history_.at(ticks);
  if (m == history_.end() || m->kind != MoveKind::dwell || m->start > ticks) return std::nullopt;
  double start = m->start;
  std::vector<Move> rest;
  double speed2 = cut(ticks, rest);
  bool still_there = !rest.empty() && rest[0].kind == MoveKind::dwell && rest[0].start <= start;
  if (still_there) rest[0].duration = 0;
  continue_plan(rest, speed2);
  return ticks_of_cut_;
}

double Motion::hold_from(double ticks, double stop_distance) {
  std::vector<Move> rest;
  double speed2 = cut(ticks, rest);
  planner_.take_queue(rest);
  planner_.stand(ticks_of_cut_);
  held_.put_first(rest, records_, std::exchange(unattached_, 0));
  double even = 0;  // deceleration with which the stop takes stop_distance
  if (stop_distance > 0) {
    std::vector<Move> ahead = held_.moves;
    if (std::fabs(length_of(take_braking(ahead, speed2)) - stop_distance) >
        kSameDistance * stop_distance)
      even = speed2 / (2 * stop_distance);
  }
  std::vector<Move> braking = take_braking(held_.moves, speed2, even);
  // Records after the last held move are not due at the stop.
  uint32_t due = unattached_ = held_.moves.empty() ? std::exchange(held_.at_end, 0) : 0;
  for (const Move& m : braking) due += m.records;
  held_.give_back(due, records_);
  resume_plan(braking, speed2, ticks_of_cut_);
  flush();
  if (uint32_t light = last_light(); light > 0) {
    record(laser_.target(), 0);
    flush();
    held_.record_first({{laser_.target(), light, 0}});
  }
  return ticks_of_cut_;
}

void Motion::release() {
  if (planner_.queued() > 0) flush();
  HeldPlan held = std::exchange(held_, {});
  planner_.rules().renumber(held.moves);
  records_.insert(records_.end(), held.records.begin(), held.records.end());
  unattached_ += held.at_end;
  if (held.moves.empty()) place_at_end();
  resume_plan(held.moves, 0, planner_.clock());
  process(false);
}

std::optional<size_t> Motion::stopped_tool() const {
  return held_.moves.empty() ? std::nullopt : std::optional<size_t>(held_.moves.front().tool);
}

std::optional<std::array<double, kAxes>> Motion::position_at(double ticks) const {
  const double* next = held() > 0 ? held_.moves.front().p0 : planner_.next_start();
  return history_.position_at(ticks - delay(), next);
}

double Motion::filament_at(double ticks, size_t extruder) const {
  return plan_.filament_mm.at(extruder) - history_.filament_after(ticks - delay(), extruder);
}

std::optional<size_t> Motion::tool_at(double ticks) const {
  auto m = history_.at(ticks - delay());
  if (m == history_.end()) return std::nullopt;
  return m->tool;
}

void Motion::suspend() {
  Suspended plan;
  plan.held = std::exchange(held_, {});
  std::copy_n(planner_.position(), kAxes, plan.end);
  for (size_t i = 0; i < machine_.extruders.size(); ++i)
    plan.extruders.push_back(planner_.extruder_position(i));
  stand_before(plan.held);
  std::copy_n(planner_.position(), kAxes, plan.stop);
  for (size_t i = 0; i < stream_.motors(); ++i) plan.counts.push_back(stream_.count(i));
  suspended_ = std::move(plan);
}

void Motion::resume() {
  planner_.set_position(suspended_->end, 0);
  for (size_t i = 0; i < suspended_->extruders.size(); ++i) {
    double position[kAxes];
    std::copy_n(suspended_->end, kAxes, position);
    position[kE] = suspended_->extruders[i];
    planner_.set_position(position, i);
  }
  planner_.set_position(suspended_->end, machine_.extruders.size());
  // Filament stays where the moves during the suspension left it.
  for (size_t i = 0; i < stream_.motors(); ++i)
    if (machine_.pushes_filament(machine_.steppers[i])) stream_.set_count(i, suspended_->counts[i]);
  held_ = std::move(suspended_->held);
  suspended_.reset();
  release();
}

void Motion::change_flow(std::vector<Move>& moves, size_t extruder, FlowChange& change) {
  for (Move& m : moves)
    if (m.extruder == extruder) change.apply(m.p0[kE], m.p1[kE], m.flow, m.owed);
}

void Motion::resume_plan(std::vector<Move>& moves, double speed2, double clock) {
  unattached_ += planner_.resume(std::move(moves), speed2, clock);
}

void Motion::continue_plan(std::vector<Move>& moves, double speed2) {
  resume_plan(moves, speed2, ticks_of_cut_);
  // Filters may still be moving after the plan has come to rest.
  const bool settling = planner_.queued() == 0 && planner_.rests() && settles_at_ > 0;
  held() > 0 || settling ? flush() : process(false);
}

void Motion::change_from(double ticks, const std::function<void(std::vector<Move>&)>& change) {
  std::vector<Move> rest;
  double speed2 = cut(ticks, rest);
  planner_.take_queue(rest);
  std::vector<Move> moves = take_braking(rest, speed2);
  change(rest);
  moves.insert(moves.end(), rest.begin(), rest.end());
  continue_plan(moves, speed2);
}

void Motion::stand_before(const HeldPlan& held) {
  for (size_t i = held.moves.size(); i-- > 0;)
    planner_.set_position(held.moves[i].p0, held.moves[i].extruder);
}

void Motion::process(bool still) {
  const double delay = this->delay();
  auto light = [this, delay](double ticks, uint32_t value) {
    stream_.set_output(laser_.target(), value, ticks + delay);
  };
  double start = now();
  std::vector<Move>& moves = planner_.settled();
  for (const Move& m : moves) {
    if (delay > 0 && m.kind != MoveKind::dwell) settles_at_ = m.end() + memory();
    plan_.add(m, machine_.clock_hz, 1);
    place(m.start + delay, m.records, false);
    if (with_steps_) laser_.follow(m, machine_.clock_hz, light);
    if (on_move) on_move(m);
    lines_.add(m.start + delay, m.main_line, m.layer);
  }
  if (still) {
    laser_.off(planner_.clock(), light);
  }
  const double known = planner_.clock();
  if (still) {
    if (settles_at_ > 0) planner_.wait_until(std::exchange(settles_at_, 0));
    place_at_end();
  }
  if (with_steps_) {
    stream_.solve(moves, known, still);
    double solved = now();
    cpu_.steps += solved - start;
    stream_.compress(planner_.clock(), still);
    forget();
    history_.add(moves);
    if (!history_.empty()) forget_rules(history_.oldest());
    merge(still);
    if (still) stream_.stand(planner_.clock());
    cpu_.compress += now() - solved;
  } else if (!moves.empty()) {
    forget_rules(moves.back());
  }
  moves.clear();
}

void Motion::place_at_end() { place(planner_.clock(), std::exchange(unattached_, 0), true); }

uint32_t Motion::last_light() const {
  uint32_t value = light_before_;
  for (const Record& r : placed_)
    if (r.target == laser_.target()) value = r.value;
  return value;
}

bool Motion::still_following() const {
  const Move* before = history_.last();
  if (before == nullptr || before->duty == 0) return false;
  for (const Record& r : placed_)
    if (r.target == laser_.target() && double(r.clock) >= before->end() - 1) return false;
  return true;
}

void Motion::place(double ticks, uint32_t n, bool without_move) {
  for (; n > 0; --n) {
    Record r = records_.front();
    records_.pop_front();
    r.without_move = without_move;
    if (r.target >= kMark) {
      r.clock = stream_.not_before(ticks);
      marks_.push_back(r);
    } else {
      r.clock = stream_.set_output(r.target, r.value, ticks);
    }
    if (r.target == laser_.target()) laser_.recorded();
    placed_.push_back(r);
  }
}

void Motion::forget() {
  auto held = stream_.hold();
  double past = std::max(double(stream_.taken_until()), passed_);
  past -= kKeptSeconds * machine_.clock_hz;
  if (stream_.commits()) past = std::min(past, double(stream_.oldest_commit()));
  past -= memory();
  history_.forget(past);
  for (; !placed_.empty() && double(placed_.front().clock) < past; placed_.pop_front())
    if (placed_.front().target == laser_.target()) light_before_ = placed_.front().value;
  stream_.forget(int64_t(past));
}

void Motion::forget_rules(const Move& oldest) {
  if (held() == 0 && !suspended_) planner_.rules().forget_before(oldest.rules);
}

double Motion::cut(double ticks, std::vector<Move>& rest) {
  auto held = stream_.hold();  // the link takes no message until the cut is complete
  in_pieces_ = false;
  int64_t at = std::max(int64_t(std::ceil(std::max(ticks, pieces_end_))), stream_.taken_until());
  ticks_of_cut_ = std::min(double(at), planner_.clock());
  double speed2 = planner_.speed2();
  if (double(at) >= planner_.clock()) {
    planner_.rewind_budget(rest);
    return speed2;
  }
  stream_.revoke(at, planner_.clock());
  const int64_t late = at + int64_t(delay());  // clock of records that the filters delay
  lines_.cut(double(late));
  while (!marks_.empty() && marks_.back().clock > late) marks_.pop_back();
  rest = history_.cut(ticks_of_cut_);
  for (const Move& m : rest) plan_.add(m, machine_.clock_hz, -1);
  bool under_way = !rest.empty() && rest[0].start < ticks_of_cut_;
  if (under_way)
    plan_.add(history_.divide(rest[0], ticks_of_cut_, speed2), machine_.clock_hz, 1);
  else if (!rest.empty())
    speed2 = rest[0].v0 * rest[0].v0;
  if (machine_.filters.on()) {
    settles_at_ = 0;
    const std::vector<Move> past = history_.before(ticks_of_cut_, memory());
    for (const Move& m : past)
      if (m.kind != MoveKind::dwell) settles_at_ = m.end() + memory();
    stream_.restart_filters(ticks_of_cut_, past);
  }
  uint32_t at_the_end = take_back(late, rest, under_way);
  if (late > at)
    for (Record& r : placed_)  // of moves before the cut that are not executed yet
      if (r.clock > at && r.target < kMark)
        r.clock = stream_.set_output(r.target, r.value, double(r.clock));
  if (!planner_.attach(at_the_end)) unattached_ += at_the_end;
  laser_.cut(under_way ? rest[0].duty > 0 : still_following());
  planner_.rewind_budget(rest);
  return speed2;
}

uint32_t Motion::take_back(int64_t at, std::vector<Move>& rest, bool under_way) {
  uint32_t at_the_end = 0, *next = &at_the_end;
  auto back = [&] {
    records_.push_front(placed_.back());
    placed_.pop_back();
  };
  auto later = [&] { return !placed_.empty() && placed_.back().clock > at; };
  for (size_t i = rest.size(); i-- > (under_way ? 1 : 0); next = &rest[i].records) {
    // Records that belong to this move come before records after it. Clocks are rounded to half a
    // tick.
    auto after_move = [&] {
      return rest[i].records > 0 || double(placed_.back().clock) > rest[i].start + delay() + 0.5;
    };
    for (; later() && placed_.back().without_move && after_move(); ++*next) back();
    // A record that is due exactly at the cut is executed before this move.
    uint32_t n = 0;
    for (; n < rest[i].records && later(); ++n) back();
    for (size_t k = rest[i].records - n; k > 0; --k)
      placed_[placed_.size() - k].without_move = true;
    rest[i].records = n;
  }
  if (under_way) {
    for (; later() && placed_.back().without_move; ++*next) back();
    next = &rest[0].records;
  }
  for (; later(); ++*next) back();
  return at_the_end;
}

}  // namespace passo
