// The reading loop, the fast path for simple moves, and what all moves have in common.
#include "gcode/interpreter.hpp"

#include <algorithm>
#include <cstdio>
#include <utility>

#include "gcode/exponents.hpp"

namespace passo {

ParseResult Interpreter::next() {
  for (;;) {
    if (!pending_.empty()) {
      Item item = std::move(pending_.front());
      pending_.pop_front();
      if (item.found == ParseResult::move) {
        if (item.joins ? take_now(item.move, false) : take(item.move)) return ParseResult::move;
        continue;
      }
      if (item.found == ParseResult::event || item.found == ParseResult::macro)
        event_ = std::move(item.event);
      if (item.found == ParseResult::error) error_ = std::move(item.error);
      return item.found;
    }
    if (arc_.active()) {
      if (next_chord()) return ParseResult::move;
      continue;
    }
    if (cycle_.active()) {
      if (next_of_cycle()) return ParseResult::move;
      continue;
    }
    if (next_word_ > 0) {
      run_words();
      continue;
    }
    const char *p, *end;
    if (!lines().next(p, end)) {
      if (!frames_[source_].empty()) {
        if (frames_[source_].back().apart) return ParseResult::need_input;
        feed_frame();
        continue;
      }
      return lines().finished() ? ParseResult::end : ParseResult::need_input;
    }
    machine_zero_ = false;
    if (lines().too_long()) {
      if (ended_line_ != 0 && !source_) continue;
      fail(Fault::line_too_long, "", 0, 0);
      continue;
    }
    if (end - p > 3 && (p[0] == 'G') && (p[1] == '1' || p[1] == '0') && p[2] == ' ' &&
        !watching() && ended_line_ == 0) {
      ParseResult found = fast_move(p + 3, end, p[1] == '0');
      if (found == ParseResult::move) return found;
      if (found == ParseResult::end) continue;
    }
    run_line(p, end);
  }
}

// Fast path for G0 and G1 with upper-case axis letters, E and F, each with a number. Returns
// ParseResult::end if the line is done and has no move, ParseResult::error if run_line() must read
// the line.
inline ParseResult Interpreter::fast_move(const char* p, const char* end, bool rapid) {
  if (any_due_) return ParseResult::error;
  double value[26];
  uint32_t have = 0;
  for (;;) {
    while (p < end && (*p == ' ' || *p == '\t')) ++p;
    if (p == end || *p == ';') break;
    unsigned k = unsigned(*p - 'A');
    if (k >= 26 || (letter_slot_[k] < 0 && k != 5)) return ParseResult::error;
    ++p;
    if (!read_number(p, end, value[k]) || looks_like_exponent(p, end)) return ParseResult::error;
    if (std::fabs(value[k]) > kLargestWord || (have >> k & 1)) return ParseResult::error;
    have |= 1u << k;
  }
  if (have >> 5 & 1) {
    if (!(value[5] > 0)) return ParseResult::error;
    feed_ = value[5] * unit_ / 60;
  }
  motion_ = rapid ? 0 : 1;
  ++commands_;
  note_moved();
  return straight(value, have & ~(1u << 5), feed_, 0, rapid) ? ParseResult::move : ParseResult::end;
}

// Calculates the target from the letters in `have` and takes the move. Returns false if nothing
// moves. The result is `move_`.
inline bool Interpreter::straight(const double* value, uint32_t have, double feed, double duration,
                                  bool rapid) {
  if (!target(value, have, relative(), 0) || retracts(have)) return false;
  move_.feed_mm_s = feed;
  move_.duration_s = duration;
  move_.radius_mm = kInfinity;
  move_.arc_inner = false;
  move_.rapid = rapid;
  move_.energy_ws = 0;
  stamp(move_);
  return take(move_);
}

// `relative`: a bit for each letter whose word is a distance. `offset`: letters of axes that keep
// the program's position and move only by a tool offset, see offset_letters().
bool Interpreter::target(const double* value, uint32_t have, uint32_t relative, uint32_t offset) {
  here(move_.target);
  uint8_t moved = 0;
  const double e_before = logical_e_;
  double hop = hop_;
  uint8_t cut = cut_;
  for (uint32_t left = have | offset; left; left &= left - 1) {
    int k = __builtin_ctz(left), j = letter_slot_[k];
    moved |= uint8_t(1u << j);
    const bool stays = offset >> k & 1;
    double v = stays ? 0 : value[k] * unit_;
    bool absolute = !stays && (relative >> k & 1) == 0;
    if (j == kE) {
      double delta = absolute ? v - logical_e_ : v;
      logical_e_ = absolute ? v : logical_e_ + v;
      if (std::fabs(delta) > kRounding)
        move_.target[kE] = position_[kE] + filament_[active_].length(delta, e_scale());
      continue;
    }
    double t = !absolute ? meant(j) + v : machine_zero_ ? v : v + origin_[j];
    if (!anywhere() && beyond(j, t)) {
      double limit = t < low_[j] ? low_[j] : high_[j];
      if (!clamp && !locked(j)) {
        logical_e_ = e_before;
        fail(Fault::out_of_range, axis_name(j), t, limit);
        return false;
      }
      if (clamp) note_clamp(j, t, limit);  // if not `clamp`, the axis is not homed: see below
      t = limit;
      cut |= uint8_t(1u << j);
    } else if (absolute) {
      cut &= uint8_t(~(1u << j));
    }
    if (j == kZ) {  // the hop is shortened if it would end above the limit
      hop = std::clamp(high_[j] - t, 0.0, hop_);
      t += hop;
    }
    if (std::fabs(t - move_.target[j]) > kRounding) move_.target[j] = t;
  }
  if (moved & locked_) {
    logical_e_ = e_before;
    fail(Fault::not_homed, axis_name(__builtin_ctz(unsigned(moved & locked_))), 0, 0);
    return false;
  }
  for (uint32_t left = skips() ? 0 : cold & moved; left; left &= left - 1) {
    int j = __builtin_ctz(left);
    if (move_.target[j] == position_[j]) continue;
    logical_e_ = e_before;
    fail(Fault::cold, j == kE ? "E" : axis_name(j), 0, 0);
    return false;
  }
  hop_ = move_.hop_mm = hop;
  cut_ = cut;
  if (any_due_) carry_out(moved);
  move_.moved = moved;
  move_.flow = extruder_.empty() ? 0 : filament_[active_].flow;
  return true;
}

bool Interpreter::take(MoveRequest& m) {
  if ((apart_ || object_ >= 0) && (apart_ || skips()) && !source_) return take_apart(m);
  return take_now(m, true);
}

// `follows`: the retraction of the filament follows this move. False for a move that join() has
// queued: there the retraction is already counted.
bool Interpreter::take_now(MoveRequest& m, bool follows) {
  if (m.kind == MoveKind::dwell && m.duration_s > 0) {
    std::copy(position_, position_ + kAxes, m.target);
    m.hop_mm = hop_;
    m.extruder = uint16_t(active_);
    m.tool = uint16_t(tool_);
    m.beam = m.energy_ws / (m.duration_s * laser_.full_w);
    move_ = m;
    move_.kind = MoveKind::dwell;
    return true;
  }
  if ((height_low > -kInfinity || height_high < kInfinity) && waits_for_height(m, follows))
    return false;
  bool travels = false, forward = false, back = false;
  for (int j = 0; j < kAxes; ++j) {
    double mm = m.target[j] - position_[j];
    if (!is_filament(j)) {
      travels |= mm != 0;
    } else if (mm != 0) {
      forward |= mm > 0, back |= mm < 0;
      if (follows) strand_of(j).drawn = owed_after(strand_of(j).drawn, mm);
    }
  }
  if (!travels && !forward && !back) return false;
  m.kind = !travels ? MoveKind::extrude : forward ? MoveKind::print : MoveKind::travel;
  if (m.kind == MoveKind::print &&
      (m.target[kX] != position_[kX] || m.target[kY] != position_[kY])) {
    const double program_z =
        tool_offset(kZ) - m.hop_mm;  // offset of the program's Z from the machine's
    layers.extrude(position_[kZ] + program_z, m.target[kZ] + program_z);
  }
  m.layer = uint16_t(std::min(layers.count(), 65535u));
  m.feature = feature_;
  m.extruder = uint16_t(active_);
  m.tool = uint16_t(tool_);
  idle_calls_ = 0;
  if (laser_.any()) shine(m);
  if (!extruder_.empty()) {
    m.owed_mm = filament_[active_].owed;
    if (m.flow > 0) filament_[active_].moved(m.target[kE] - position_[kE], e_scale());
  }
  std::copy(m.target, m.target + kAxes, position_);
  if (!extruder_.empty()) extruder_[active_] = position_[kE];
  if (&m != &move_) move_ = m;
  move_.kind = m.kind;
  return true;
}

bool Interpreter::waits_for_height(const MoveRequest& m, bool follows) {
  if (!(m.target[kE] > position_[kE]) ||
      (m.target[kX] == position_[kX] && m.target[kY] == position_[kY]))
    return false;
  const double z = m.target[kZ] + tool_offset(kZ) - m.hop_mm;
  if (z >= height_low && z <= height_high) return false;
  height_low = -kInfinity, height_high = kInfinity;
  Item move{}, event{};
  move.found = ParseResult::move;
  move.move = m;
  move.joins = !follows;
  char text[40];
  std::snprintf(text, sizeof text, "Z=%.9g", z);
  event.found = ParseResult::event;
  event.event = {m.line, 0, 0, 0, "TUNING_TOWER", text};
  pending_.push_front(std::move(move));
  pending_.push_front(std::move(event));
  return true;
}

// Sets the line numbers of a move: those of the program, or 0 for a line from a console.
void Interpreter::stamp(MoveRequest& m) const {
  m.line = source_ ? 0 : number();
  m.main_line = source_ ? 0 : sources_[0].number();
  m.layer = uint16_t(std::min(layers.count(), 65535u));
  m.feature = feature_;
}

// Sets the laser energy per mm of a move from position_, and the speed above which the laser cannot
// deliver that energy.
void Interpreter::shine(MoveRequest& m) const {
  double mm2 = 0, longest = 0;
  for (int j = 0; j < kAxes; ++j) {
    double mm = std::fabs(m.target[j] - position_[j]);
    longest = std::max(longest, mm);
    if (j <= kZ) mm2 += mm * mm;
  }
  double mm = mm2 > 0 ? std::sqrt(mm2) : longest;
  double density = m.energy_ws > 0 ? m.energy_ws / mm : m.rapid ? 0 : density_;
  m.beam = density / laser_.full_w;
  m.fastest_mm_s = density > 0 ? laser_.most_w / density : 0;
}

}  // namespace passo
