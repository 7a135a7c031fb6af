// The planned laws that one motor or axis follows, in its own unit, and the filters between them
// and what it does.
#pragma once
#include <vector>

#include "filters/phases.hpp"
#include "machine/filters.hpp"
#include "plan/move.hpp"

namespace passo {

class PlannedLaws {
 public:
  explicit PlannedLaws(double hz) : hz_(hz) { all_.reserve(kMost); }

  // No laws; those of the next calls are filtered by `filters`, which must outlive them.
  void clear(const Filters& filters);
  // `scale`: of the motor's unit for a mm. An axis is followed in the slot of its position; a motor
  // that several axes move is the sum of them.
  void follow_axis(int slot, double scale);
  void follow_extruder(int extruder, double scale);

  // At most three. Laws of filters refer to them.
  std::vector<Phases>& all() { return all_; }
  const std::vector<Phases>& all() const { return all_; }
  // What their filters make of each of them.
  const Kernel& kernel(size_t i) const { return parts_[i].kernel; }

  // Moves of another extruder do not move this one.
  bool idles(const Move& m) const { return extruder_ >= 0 && m.extruder != extruder_; }
  // Everything is at rest at the start of a move.
  void begin(const Move& m);
  // Not a dwell. Motion from the clock `until` on is left out.
  void add(const Move& m, double until);
  void resume(double clock) {
    for (Phases& p : all_) p.resume(clock);
  }
  void stand() {
    for (Phases& p : all_) p.stand();
  }

 private:
  static constexpr size_t kMost = 3;
  struct Part {
    int slot;  // of the position
    Kernel kernel;
    double scale;
  };
  double hz_;
  const Filters* filters_ = nullptr;
  int extruder_ = -1;
  // An extruder that follows different kernels of X and Y: its position is a sum of parts, which
  // move with X, with Y, and with neither. A move is divided by its direction squared.
  bool parted_ = false;
  std::vector<Part> parts_;
  std::vector<Phases> all_;

  void add_parts(const Move& m, double until);
};

}  // namespace passo
