// The filament of moves that have been read and not yet taken.
#pragma once
#include "gcode/interpreter.hpp"

namespace passo {

inline double Interpreter::meant_mm() const {
  double mm = arc_.active() ? arc_.left(kE) : 0, from = position_[kE];
  for (const Item& item : pending_) {
    if (item.found != Found::move || item.move.kind == MoveKind::dwell) continue;
    if (item.move.flow > 0) mm += item.move.target[kE] - from;
    from = item.move.target[kE];
  }
  return mm;
}

inline void Interpreter::change_flow(size_t extruder, FlowChange& change) {
  Filament& filament = filament_[extruder];
  double from = extruder_[extruder], owed = filament.owed;
  filament.flow = change.flow();
  filament.owed = change.owed(owed);
  if (owed > 0) filament.scale *= filament.owed / owed;
  extruder_[extruder] = change.place(from);
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
    if (item.found == Found::move && item.move.kind != MoveKind::dwell)
      item.move.target[kE] = pass(item.move.target[kE], item.move.flow);
  if (!arc_.active()) return;
  double start = change.place(from), end = pass(from + arc_.left(kE), arc_move_.flow);
  arc_.set_left(kE, start, end - start);
}

}  // namespace passo
