// The planned laws that one motor or axis follows, in its own unit, and the filter kernel of each.
#pragma once
#include <vector>

#include "filters/phases.hpp"
#include "machine/filters.hpp"
#include "plan/move.hpp"

namespace passo {

class PlannedLaws {
 public:
  explicit PlannedLaws(double hz) : hz_(hz) { all_.reserve(kMost); }

  // Removes all laws. The laws that follow are filtered by `filters`, which must outlive them.
  void clear(const Filters& filters);
  // Adds laws that the motor follows; `scale` is its units per mm. A motor that several axes move
  // is the sum of their laws.
  void follow_axis(int slot, double scale);
  void follow_extruder(int extruder, double scale);

  // At most three laws. The filter forms keep pointers to them.
  std::vector<Phases>& all() { return all_; }
  const std::vector<Phases>& all() const { return all_; }
  // The filter kernel of law i.
  const Kernel& kernel(size_t i) const { return parts_[i].kernel; }

  // Moves of another extruder do not move this extruder.
  bool idles(const Move& m) const { return extruder_ >= 0 && m.extruder != extruder_; }
  // Everything rests at the start of this move.
  void begin(const Move& m);
  // Adds a move that is not a dwell. Motion after the clock `until` is left out.
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
    int slot;  // of the axis, or kE
    Kernel kernel;
    double scale;
  };
  double hz_;
  const Filters* filters_ = nullptr;
  int extruder_ = -1;
  // The extruder follows X and Y, whose kernels differ. Its position is a sum of three parts, which
  // follow X, Y, and neither. The squared components of a move's direction are the fractions of X
  // and Y.
  bool parted_ = false;
  std::vector<Part> parts_;
  std::vector<Phases> all_;

  void add_parts(const Move& m, double until);
};

}  // namespace passo
