// Retraction (G10, G11, M209), filament changes (M603, M701, M702) and flow (M221).
#include <algorithm>
#include <cmath>
#include <utility>

#include "gcode/interpreter.hpp"

namespace passo {

namespace {

constexpr double kMinRetractMm = 0.1, kMaxRetractMm = 10;  // length of a move that M209 replaces

}  // namespace

// G10 and G11: G10 retracts the filament, then lifts Z; G11 does the reverse. `swap` uses the
// length for a tool change, which the next G11 returns.
void Interpreter::run_retract(bool in, bool swap) {
  if (machine_->extruders.empty() || in == drawn_[active_].back) return;
  if (!skips() && (cold >> kE & 1)) return fail(Fault::cold, "E", 0, 0);
  Drawn& drawn = drawn_[active_];
  drawn.back = in;
  if (in) {
    drawn.swapped = swap;
    drawn.mm = swap ? retraction_.swap_mm : retraction_.mm;
    queue_step(kE, -drawn.mm, retraction_.feed_mm_s);
    if (hop_ > 0) return;  // another extruder has lifted Z
    hop_ = std::clamp(retraction_.hop_mm, 0.0, std::max(0.0, high_[kZ] - position_[kZ] - gap(kZ)));
    queue_step(kZ, hop_, kInfinity);
  } else {
    queue_step(kZ, -std::exchange(hop_, 0), kInfinity);
    double extra = drawn.swapped ? retraction_.swap_recover_mm : retraction_.recover_mm;
    queue_step(
        kE, std::max(drawn.mm + extra, 0.0),  // a negative length is not pushed
        retraction_.recover_feed_mm_s > 0 ? retraction_.recover_feed_mm_s : retraction_.feed_mm_s);
  }
}

// M209: replaces a move of filament alone, with which a slicer retracts, by the retraction of M207
// and M208. The program's E changes as its own words say.
bool Interpreter::retracts(uint32_t have) {
  double mm = move_.target[kE] - position_[kE];
  if (!auto_retract_ || have != 1u << ('E' - 'A')) return false;
  if (std::fabs(mm) < kMinRetractMm || std::fabs(mm) > kMaxRetractMm) return false;
  if (drawn_[active_].back == (mm < 0))
    return false;  // it neither retracts nor returns a retraction
  run_retract(mm < 0);
  return true;
}

void Interpreter::forget_retraction() {
  for (Filament& filament : filament_) filament.owed = 0;
  std::fill(drawn_.begin(), drawn_.end(), Drawn{});
  std::fill(strands_.begin(), strands_.end(), Strand{});
  std::fill(std::begin(axis_strands_), std::end(axis_strands_), Strand{});
  hop_ = 0;
}

// M603 sets the lengths of a tool's filament path. M701 loads the filament of the tool in use, M702
// unloads it; both can lift Z meanwhile. Returns false for a query.
bool Interpreter::run_filament(int code, const Arguments& a) {
  if (code == 603 && a.empty()) return false;
  double tool = a.value('T', double(tool_));
  bool there = tool >= 0 && tool < double(machine_->tools.size()) &&
               machine_->tools[size_t(tool)].extruder >= 0;
  if (!there || (code != 603 && tool != double(tool_))) {
    fail(Fault::missing_tool, "T", tool, double(machine_->tools.size()));
    return true;
  }
  Change& change = change_[size_t(machine_->tools[size_t(tool)].extruder)];
  double load = a.value('L', change.load_mm), unload = a.value('U', change.unload_mm);
  double lift =
      std::clamp(a.value('Z', 0), 0.0, std::max(0.0, high_[kZ] - position_[kZ] - gap(kZ)));
  if (!within('L', load, 0, kMaxChangeMm) || !within('U', unload, 0, kMaxChangeMm)) return true;
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

void Interpreter::leave_filament(size_t extruder, double mm) {
  extruder_[extruder] -= mm;
  if (extruder == active_) {
    position_[kE] -= mm;
    arc_.shift(kE, -mm);
  }
  for (Item& item : pending_)  // a tool change comes after them, so they move the extruder in use
    if (item.found == ParseResult::move && extruder == active_) item.move.target[kE] -= mm;
}

double Interpreter::meant_mm() const {
  double mm = arc_.active() ? arc_.left(kE) : 0, from = position_[kE];
  for (const Item& item : pending_) {
    if (item.found != ParseResult::move || item.move.kind == MoveKind::dwell) continue;
    if (item.move.flow > 0) mm += item.move.target[kE] - from;
    from = item.move.target[kE];
  }
  return mm;
}

void Interpreter::change_flow(size_t extruder, FlowChange& change) {
  Filament& filament = filament_[extruder];
  double from = extruder_[extruder], owed = filament.owed;
  filament.owed = change.owed(owed);
  if (owed > 0) filament.scale *= filament.owed / owed;
  extruder_[extruder] = change.position(from);
  if (extruder != active_) return;
  position_[kE] = extruder_[extruder];
  auto pass = [&](double to, double& flow) {
    double was_owed = owed, end = to;
    owed = flow > 0 ? owed_after(owed, to - from) : owed;
    change.apply(from, end, flow, was_owed);
    from = to;
    return end;
  };
  for (Item& item : pending_)
    if (item.found == ParseResult::move && item.move.kind != MoveKind::dwell)
      item.move.target[kE] = pass(item.move.target[kE], item.move.flow);
  if (!arc_.active()) return;
  double start = change.position(from), end = pass(from + arc_.left(kE), arc_move_.flow);
  arc_.set_left(kE, start, end - start);
}

}  // namespace passo
