// The planned laws that one motor or axis follows, in its own unit, and the filters between them
// and what it does.
#pragma once
#include <vector>

#include "filters/phases.hpp"
#include "filters/smooth_law.hpp"
#include "filters/taps.hpp"
#include "machine/filters.hpp"
#include "plan/move.hpp"

namespace passo {

// Calls add(weight, delay in ticks) for each impulse that shapes the position in a slot; a slot
// without a shaper is only delayed.
template <class Add>
void each_impulse(const Filters& filters, double hz, int slot, Add&& add) {
  const double delay = filters.delay(hz);
  if (slot > kZ || filters.shapers[slot].empty()) return add(1.0, delay);
  const double mean = Filters::mean(filters.shapers[slot]);
  for (const Impulse& impulse : filters.shapers[slot])
    add(impulse.weight, delay + (impulse.at - mean) * hz);
}
inline void add_to(Taps& taps, const Filters& filters, double hz, int slot, Phases* phases) {
  each_impulse(filters, hz, slot,
               [&](double weight, double delay) { taps.add(phases, weight, delay); });
}
// The same if jerk is limited.
inline void add_to(SmoothLaw& law, const Filters& filters, double hz, int slot, Phases* phases) {
  each_impulse(filters, hz, slot, [&](double weight, double delay) {
    law.add(phases, weight, delay, filters.box_s * hz);
  });
}

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
  // The filament is advanced.
  bool advances() const { return advances_; }
  // Filters that only a SmoothLaw has: a limit of jerk, or an advance that is shaped.
  bool smooth() const { return filters_->boxed() || (advances_ && shaped_); }
  // Adds the laws with their filters.
  void add_to(Taps& taps);
  void add_to(SmoothLaw& law);

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
    int slot, shaped_as;  // of the position, and of the shaper
    double scale;
  };
  double hz_;
  const Filters* filters_ = nullptr;
  int extruder_ = -1;
  bool advances_ = false, shaped_ = false;
  // An extruder that follows different shapers of X and Y: its position is a sum of parts, which
  // move with X, with Y, and with neither. A move is divided by its direction squared.
  bool parted_ = false;
  std::vector<Part> parts_;
  std::vector<Phases> all_;

  void add_parts(const Move& m, double until);
};

}  // namespace passo
