// The straight pieces of a planned path, without times.
#pragma once
#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "plan/move.hpp"

namespace passo {

struct PathSegment {
  double from[3], to[3];  // X, Y, Z in mm
  double filament_mm;     // filament of this piece, mm; valid if it prints
  uint32_t line;          // of the file
  uint16_t extruder;
  bool prints;
  bool after_filament;  // filament has moved alone before it: a retraction was ended
};

class PathSegments {
 public:
  // A settled move, in the order of time. Moves of filament alone are left out.
  void add(const Move& move) {
    if (move.kind == MoveKind::extrude) filament_ = true;
    if (move.kind == MoveKind::dwell || !move.cartesian) return;
    PathSegment s{};
    std::copy_n(move.p0, 3, s.from);
    std::copy_n(move.p1, 3, s.to);
    s.filament_mm = move.p1[kE] - move.p0[kE];
    s.line = move.main_line;
    s.extruder = move.extruder;
    s.prints = move.kind == MoveKind::print && s.filament_mm > 0;
    s.after_filament = std::exchange(filament_, false);
    segments_.push_back(s);
  }
  std::vector<PathSegment> take() { return std::exchange(segments_, {}); }

 private:
  std::vector<PathSegment> segments_;
  bool filament_ = false;
};

}  // namespace passo
