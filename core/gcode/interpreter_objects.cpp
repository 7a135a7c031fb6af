// Cancelled objects of a print: skips their moves, and moves on to the next object after them.
#include <algorithm>
#include <cctype>
#include <cmath>
#include <iterator>
#include <utility>

#include "gcode/interpreter.hpp"

namespace passo {

// Carries out a command about objects if the program contains it. A console's goes to the caller.
void Interpreter::run_objects(std::string_view code, std::string_view text) {
  while (!text.empty() && std::isspace(uint8_t(text.front()))) text.remove_prefix(1);
  if (source_) return code == "M486" ? emit('M', 486, 0, "", text) : emit(0, 0, 0, code, text);
  for (const ObjectOrder& order : ObjectText::read(code, text)) obey(order);
}

void Interpreter::obey(const ObjectOrder& order) {
  Objects& all = *objects_;
  auto enter = [&](int object) {
    object_ = object;
    object_lines_.add(sources_[0].number(), object);
  };
  auto cancel = [&](bool cancelled) {
    const int number = order.number < 0 ? all.named(order.name) : all.numbered(order.number);
    if (number >= 0) all.cancel(number, cancelled);
  };
  switch (order.action) {
    case ObjectAction::count:
      return all.reserve(order.number);
    case ObjectAction::define:
      return all.define(order);
    case ObjectAction::begin:
      return enter(order.number < 0 ? all.named(order.name) : all.numbered(order.number));
    case ObjectAction::name:
      if (object_ >= 0) all.call(object_, order.name);
      return;
    case ObjectAction::end:
      return enter(-1);
    case ObjectAction::cancel:
      return cancel(true);
    case ObjectAction::cancel_current:
      if (object_ >= 0) all.cancel(object_, true);
      return;
    case ObjectAction::restore:
      return cancel(false);
    case ObjectAction::restore_all:
      return all.restore_all();
  }
}

// A new program starts: it has no objects yet, and starts at the machine's position.
void Interpreter::forget_objects() {
  objects_ = std::make_shared<Objects>();
  object_lines_.clear();
  object_ = -1;
  std::fill(std::begin(gap_), std::end(gap_), 0.0);
  for (Strand& strand : strands_) strand.excess = 0;
  for (Strand& strand : axis_strands_) strand.excess = 0;
  apart_ = false;
}

// The filament of slot j will end `mm` further than the program expects. The program's E stays.
void Interpreter::pass_filament(int j, double mm) {
  arc_.shift(j, mm);
  for (Item& item : pending_)
    if (item.found == ParseResult::move) item.move.target[j] += mm;
  if (j != kE) origin_[j] += mm;
}

void Interpreter::look_apart() {
  apart_ = std::any_of(std::begin(gap_), std::end(gap_), [](double mm) { return mm != 0; });
  auto differs = [this](const Strand& strand) { apart_ |= strand.excess != 0; };
  std::for_each(strands_.begin(), strands_.end(), differs);
  std::for_each(std::begin(axis_strands_), std::end(axis_strands_), differs);
}

// Takes a move of the program while its object is cancelled or directly after that. Dwells are
// carried out.
bool Interpreter::take_apart(MoveRequest& m) {
  if (m.kind == MoveKind::dwell && m.duration_s > 0) return take_now(m, true);
  if (!skips()) return join(m);
  skip(m);
  return false;
}

// Advances the program without moving the machine. Filament that the skipped moves extrude is
// dropped; a retraction is remembered in the strand's excess.
void Interpreter::skip(const MoveRequest& m) {
  bool forward = false, back = false, travels = false;
  for (int j = 0; j < kAxes; ++j) {
    const double mm = m.target[j] - (position_[j] + gap_[j]);
    if (mm == 0) continue;
    if (!is_filament(j)) {
      travels |= j != kZ;
      gap_[j] = m.target[j] - position_[j];
      if (std::fabs(gap_[j]) <= kRounding) gap_[j] = 0;
      continue;
    }
    forward |= mm > 0, back |= mm < 0;
    Strand& strand = strand_of(j);
    strand.excess = strand.drawn - owed_after(strand.drawn - strand.excess, mm);
    if (std::fabs(strand.excess) <= kRounding) strand.excess = 0;
    if (j == kE && m.flow > 0) filament_[active_].moved(mm, e_scale());
    pass_filament(j, -mm);
  }
  if (travels && !forward) skipped_feed_ = m.feed_mm_s;
  if (back || (forward && !travels)) skipped_strand_feed_ = m.feed_mm_s;
  idle_calls_ = 0;
  look_apart();
}

// The first moves after a cancelled object. A retraction or a lift takes place at the machine's
// position. Any other move first brings the machine to the program's position: up, across and down.
// Before that, the filament is retracted as far as the program has retracted it.
bool Interpreter::join(const MoveRequest& m) {
  double start[kAxes], by[kAxes];  // position of the program, and distance of its move
  here(start);
  bool forward = false, across = false, any = false;
  for (int j = 0; j < kAxes; ++j) {
    by[j] = m.target[j] - start[j];
    any |= by[j] != 0;
    forward |= is_filament(j) && by[j] > 0;
    across |= !is_filament(j) && j != kZ && by[j] != 0;
  }
  if (!any) return false;
  const bool arrives = forward || across || by[kZ] < 0;
  for (int j = 0; arrives && j < kAxes; ++j) {  // the cancelled object may have ended out of range
    const double to = forward ? start[j] : m.target[j];
    if (is_filament(j) || !beyond(j, to)) continue;
    fail(Fault::out_of_range, axis_name(j), to, to < low_[j] ? low_[j] : high_[j]);
    return false;
  }

  std::vector<Item> items;
  double at[kAxes];  // end of the moves queued so far
  std::copy(position_, position_ + kAxes, at);
  auto as_meant = [&] {
    Item item{};
    item.found = ParseResult::move;
    item.joins = true;
    item.move = m;
    std::copy(at, at + kAxes, item.move.target);
    items.push_back(std::move(item));
  };
  // Queues a travel that is not part of the program.
  auto step = [&](double feed) {
    as_meant();
    MoveRequest& s = items.back().move;
    s.kind = MoveKind::travel;
    if (feed > 0) s.feed_mm_s = feed;
    s.moved = 0;
    for (int j = 0; j < kAxes; ++j)
      if (at[j] != position_[j]) s.moved |= uint8_t(1u << j);
    s.duration_s = s.energy_ws = s.hop_mm = s.flow = 0;
    s.radius_mm = kInfinity;
    s.arc_inner = false;
    s.rapid = true;  // the laser is off
  };
  // Moves the filament of slot j by `mm`, while the program moves it by `meant`.
  auto feed_strand = [&](int j, double mm, double meant) {
    Strand& strand = strand_of(j);
    const double drawn = owed_after(strand.drawn, mm);
    strand.excess = drawn - owed_after(strand.drawn - strand.excess, meant);
    if (std::fabs(strand.excess) <= kRounding) strand.excess = 0;
    if (j == kE && m.flow > 0 && meant != 0) filament_[active_].moved(meant, e_scale());
    strand.drawn = drawn;
    pass_filament(j, mm - meant);
    at[j] += mm;
  };
  auto each_strand = [&](auto&& with) {
    for (int j = 0; j < kAxes; ++j)
      if (is_filament(j) && (j != kE || !extruder_.empty())) with(j, strand_of(j));
  };
  // Retracts or returns filament as far as the program has. With `only_back`, only retracts.
  auto settle = [&](bool only_back) {
    bool moves = false;
    each_strand([&](int j, Strand& strand) {
      if (only_back ? strand.excess >= 0 : strand.excess == 0) return;
      feed_strand(j, strand.excess, 0);
      moves = true;
    });
    if (moves) step(skipped_strand_feed_);
  };
  // Carries out the retraction within m, less what is retracted already.
  auto retract = [&] {
    each_strand([&](int j, Strand& strand) {
      if (by[j] < 0) feed_strand(j, std::min(0.0, by[j] + strand.excess), by[j]);
    });
  };

  if (!arrives) {
    at[kZ] = std::max(at[kZ], by[kZ] > 0 ? m.target[kZ] : at[kZ]);
    retract();
    if (!std::equal(at, at + kAxes, position_)) {
      as_meant();
      items.back().move.hop_mm = items.back().move.flow = 0;
    }
    gap_[kZ] = m.target[kZ] - at[kZ];
    if (std::fabs(gap_[kZ]) <= kRounding) gap_[kZ] = 0;
  } else {
    const double* to = forward ? start : m.target;
    bool far = false;
    auto sideways = [&](int j) { return j != kZ && !is_filament(j); };
    for (int j = 0; j < kAxes; ++j) far |= sideways(j) && std::fabs(to[j] - at[j]) > kRounding;
    if (far) settle(true);
    const double top = std::max({at[kZ], start[kZ], to[kZ]});
    if (far && top - at[kZ] > kRounding) {
      at[kZ] = top;
      step(skipped_feed_);
    }
    for (int j = 0; j < kAxes; ++j)
      if (sideways(j)) at[j] = to[j];
    if (!far) at[kZ] = to[kZ];
    if (!forward) {
      retract();
      as_meant();
      items.back().move.hop_mm = items.back().move.flow = 0;
    } else if (far || at[kZ] != position_[kZ]) {
      step(skipped_feed_);
    }
    if (far && std::fabs(to[kZ] - at[kZ]) > kRounding) {
      at[kZ] = to[kZ];
      step(forward ? skipped_feed_ : m.feed_mm_s);
    }
    if (forward && !across && by[kZ] == 0) {
      each_strand([&](int j, Strand& strand) { feed_strand(j, strand.excess + by[j], by[j]); });
      as_meant();
      items.back().move.flow = 0;
    } else if (forward) {
      settle(false);
      for (int j = 0; j < kAxes; ++j) at[j] = is_filament(j) ? at[j] + by[j] : m.target[j];
      each_strand([&](int j, Strand& s) { s.drawn = owed_after(s.drawn, by[j]); });
      as_meant();
    }
    std::fill(std::begin(gap_), std::end(gap_), 0.0);
  }
  pending_.insert(pending_.begin(), std::make_move_iterator(items.begin()),
                  std::make_move_iterator(items.end()));
  look_apart();
  return false;
}

}  // namespace passo
