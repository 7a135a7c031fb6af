// Moves that the program asks for without words of their own: saved places, retraction, filament;
// and what goes with moves: a laser's light, a slicer's comments.
#pragma once
#include "gcode/interpreter.hpp"

namespace passo {

// G60 saves where the program means the machine to be as S; G61 goes there with the axes that it
// names, so far beside it as their words say, with X, Y, Z if it names none. F counts for this move
// alone.
inline void Interpreter::run_saved(bool save, const Word* w, const Word* end) {
  double value[26] = {}, feed = kInfinity, slot = 0;
  uint32_t have = 0;
  for (const Word* x = w; x < end; ++x) {
    int k = x->letter - 'A';
    if (x->letter == 'S' && x->number) slot = x->value;
    if (x->letter == 'F' && x->number && x->value > 0) feed = x->value * unit_ / 60;
    if (k < 0 || k >= 26 || letter_slot_[k] < 0) continue;
    have |= 1u << k;
    value[k] = x->number ? x->value * unit_ : 0;
  }
  if (!within('S', slot, 0, kSaved - 1)) return;
  if (slot != std::floor(slot)) return fail(Fault::number, "S", slot, kSaved - 1);
  Saved& saved = saved_[int(slot)];
  if (save) {
    saved.valid = true;
    for (int j = 0; j < kAxes; ++j) saved.at[j] = meant(j);
    return emit('G', 60, 0, "", "S" + std::to_string(int(slot)));
  }
  if (!saved.valid) return fail(Fault::unsaved, "S", slot, 0);
  if (have == 0) have = 1u << ('X' - 'A') | 1u << ('Y' - 'A') | 1u << ('Z' - 'A');
  for (int k = 0; k < 26; ++k) {  // as relative words
    if ((have >> k & 1) == 0) continue;
    int j = letter_slot_[k];
    double by = saved.at[j] + value[k] - meant(j);
    value[k] = (j == kE ? by / e_scale() : by) / unit_;
  }
  if (target(value, have, ~0u, offset_letters(have))) queue_straight(feed, 0, false);
}

// The move that has just got its target moves these slots: their offsets are no longer due.
inline void Interpreter::carry_out(uint8_t moved) {
  for (int j = 0; j < 3; ++j) owed_.from[j] = position_[j], owed_.mm[j] = due_[j];
  owed_.tool = tool_;
  owed_.line = number();
  for (int j = 0; j < 3; ++j)
    if (moved >> j & 1) owe(j, 0);
}

// Where the machine is once it has carried out the offset that is due. Returns the slot of an axis
// for which that is beyond its limit, where `at` ends, or -1.
inline int Interpreter::place_of_tool(double* at) const {
  here(at);
  int out = -1;
  for (int j = 0; any_due_ && !machine_zero_ && j < 3; ++j) {
    if (due_[j] == 0 || locked(j)) continue;
    double t = meant(j);
    if (beyond(j, t)) {
      t = t < low_[j] ? low_[j] : high_[j];
      out = j;
    }
    at[j] = t + (j == kZ ? std::clamp(high_[j] - t, 0.0, hop_) : 0);
  }
  return out;
}

// Whether the target that move_ has now takes filament forward.
inline bool Interpreter::lays_filament() const {
  for (int j = 0; j < kAxes; ++j)
    if (is_filament(j) && move_.target[j] > position_[j]) return true;
  return false;
}

// A travel to `to`, from where a line of filament or an arc begins with the tool in use.
inline void Interpreter::queue_offset(const double* to, double feed) {
  Item item{};
  item.found = Found::move;
  MoveRequest& m = item.move;
  std::copy(to, to + kAxes, m.target);
  double from[kAxes];
  here(from);
  for (int j = 0; j < 3; ++j)
    if (to[j] != from[j]) m.moved |= uint8_t(1u << j);
  if (m.moved == 0) return;
  m.hop_mm = hop_;
  m.feed_mm_s = feed;
  m.radius_mm = kInfinity;
  m.rapid = true;  // no laser burns on it
  stamp(m);
  m.kind = MoveKind::travel;
  pending_.push_back(std::move(item));
}

// A move of slot j by so much, of which the program's own coordinates know nothing.
inline void Interpreter::queue_step(int j, double by, double feed) {
  if (by == 0) return;
  Item item{};
  item.found = Found::move;
  MoveRequest& m = item.move;
  double start[kAxes];
  here(start);
  const double* from = start;
  for (const Item& x : pending_)
    if (x.found == Found::move) from = x.move.target;
  std::copy(from, from + kAxes, m.target);
  m.target[j] += by;
  m.hop_mm = hop_;
  m.feed_mm_s = feed;
  m.radius_mm = kInfinity;
  stamp(m);
  m.kind = MoveKind::travel;
  m.moved = uint8_t(1u << j);
  pending_.push_back(std::move(item));
}

// M603 sets the lengths of a tool's filament path; M701 pushes the filament of the tool in use in,
// M702 pulls it out, lifted by Z meanwhile. False: a question.
inline bool Interpreter::run_filament(int code, const Word* w, const Word* end) {
  auto length_of = [&](char letter, double otherwise) {
    for (const Word* x = w; x < end; ++x)
      if (x->letter == letter && x->number) return x->value;
    return otherwise;
  };
  if (code == 603 && w == end) return false;
  double tool = length_of('T', double(tool_));
  bool there = tool >= 0 && tool < double(machine_->tools.size()) &&
               machine_->tools[size_t(tool)].extruder >= 0;
  if (!there || (code != 603 && tool != double(tool_))) {
    fail(Fault::missing_tool, "T", tool, double(machine_->tools.size()));
    return true;
  }
  Change& change = change_[size_t(machine_->tools[size_t(tool)].extruder)];
  double load = length_of('L', change.load_mm), unload = length_of('U', change.unload_mm);
  double lift =
      std::clamp(length_of('Z', 0), 0.0, std::max(0.0, high_[kZ] - position_[kZ] - gap(kZ)));
  if (!within('L', load, 0, kLongestChange) || !within('U', unload, 0, kLongestChange)) return true;
  if (code == 603) {
    change = {load, unload};
  } else if (!skips() && (cold >> kE & 1)) {
    fail(Fault::cold, "E", 0, 0);
  } else if (lift > 0 && locked(kZ)) {
    fail(Fault::not_homed, axis_name(kZ), 0, 0);
  } else {
    queue_step(kZ, lift, kInfinity);
    queue_step(kE, code == 701 ? load : -unload, code == 701 ? kLoadMmS : kUnloadMmS);
    queue_step(kZ, -lift, kInfinity);
  }
  return true;
}

// G28 B: back to machine position `to`, X and Y first, unless arms lift them together with Z: where
// these are at home there is no way aside.
inline void Interpreter::queue_return(const double* to) {
  here(move_.target);
  const bool together = machine_->axes[size_t(kZ)].by_arms;
  for (int j = 0; j < kAxes; ++j)
    if (j != kE && (j != kZ || together)) move_.target[j] = to[j];
  move_.moved = 0;
  move_.hop_mm = hop_;
  queue_straight(kInfinity, 0, true);
  move_.target[kZ] = to[kZ];
  queue_straight(kInfinity, 0, true);
}

// Firmware retraction (G10, G11): filament first, then the hop; back in the reverse order.
// `swap`: by the length for a change of tools, and so is what G11 gives back then.
inline void Interpreter::run_retract(bool in, bool swap) {
  if (machine_->extruders.empty() || in == drawn_[active_].back) return;
  if (!skips() && (cold >> kE & 1)) return fail(Fault::cold, "E", 0, 0);
  Drawn& drawn = drawn_[active_];
  drawn.back = in;
  if (in) {
    drawn.swapped = swap;
    drawn.mm = swap ? retraction_.swap_mm : retraction_.mm;
    queue_step(kE, -drawn.mm, retraction_.feed_mm_s);
    if (hop_ > 0) return;  // another extruder's
    hop_ = std::clamp(retraction_.hop_mm, 0.0, std::max(0.0, high_[kZ] - position_[kZ] - gap(kZ)));
    queue_step(kZ, hop_, kInfinity);
  } else {
    queue_step(kZ, -std::exchange(hop_, 0), kInfinity);
    double extra = drawn.swapped ? retraction_.swap_recover_mm : retraction_.recover_mm;
    queue_step(
        kE, std::max(drawn.mm + extra, 0.0),  // less than nothing is not pushed
        retraction_.recover_feed_mm_s > 0 ? retraction_.recover_feed_mm_s : retraction_.feed_mm_s);
  }
}

// What the laser gives to a move from position_, and the speed at which that is all it may give.
inline void Interpreter::shine(MoveRequest& m) const {
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

// Layers and features, as slicers tell them.
inline void Interpreter::comment(std::string_view text) {
  layers.comment(text);
  constexpr std::string_view kType = "TYPE:";
  if (text.substr(0, kType.size()) == kType) {
    text.remove_prefix(kType.size());
    while (!text.empty() && std::isspace(uint8_t(text.back()))) text.remove_suffix(1);
    std::string name = readable(text);
    auto at = std::find(features_.begin(), features_.end(), name);
    if (at == features_.end() && features_.size() < 1000) at = features_.insert(at, name);
    feature_ = at == features_.end() ? 0 : uint16_t(at - features_.begin());
  }
}

}  // namespace passo
