// The motion filters of a machine.
#pragma once
#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <tuple>

#include "base/types.hpp"
#include "machine/filters/drive_gap.hpp"
#include "machine/filters/input_shaper.hpp"
#include "machine/filters/jerk_limit.hpp"
#include "machine/filters/kernel.hpp"
#include "machine/filters/pressure_advance.hpp"

namespace passo {

// The filtered position depends on the past only: every motor follows the plan `delay` later, so
// that the earliest copy of a kernel needs only positions that are planned already. A cut of the
// plan and of the steps is then at one clock.
class Filters {
 public:
  // The filters, in the order in which they act; only `set` changes them. Those that act on kernels
  // have `apply(kernel, slot, extruder)`: of an axis, with extruder -1, or of the filament of an
  // extruder, in slot kE or in the slot of the axis that it follows.
  InputShaper shaper;
  JerkLimit jerk;
  PressureAdvance advance;
  DriveGaps gaps;
  auto all() { return std::tie(shaper, jerk, advance, gaps); }
  auto all() const { return std::tie(shaper, jerk, advance, gaps); }

  // Changes a setting of a filter for one axis or extruder. Throws std::invalid_argument.
  void set(std::string_view name, size_t index, const Numbers& numbers) {
    bool found = false;
    auto look_in = [&]<class Filter>(Filter& filter) {
      for (const Setting<Filter>& setting : Filter::settings())
        if (setting.name == name) setting.set(filter, index, numbers), found = true;
    };
    std::apply([&](auto&... filters) { (look_in(filters), ...); }, all());
    if (!found)
      throw std::invalid_argument("no motion filter has the setting " + std::string(name));
    renew();
  }
  // While homing and probing, no filter acts.
  void suspend(bool suspended) {
    suspended_ = suspended;
    renew();
  }

  bool on() const { return on_; }
  // What all filters make of the law in a slot; `extruder`: of its filament that moves with it.
  Kernel kernel(int slot, int extruder = -1) const {
    Kernel kernel;
    auto apply = [&](const auto& filter) {
      if constexpr (requires { filter.apply(kernel, slot, extruder); })
        filter.apply(kernel, slot, extruder);
    };
    if (!suspended_) std::apply([&](const auto&... filters) { (apply(filters), ...); }, all());
    return kernel;
  }
  bool advances(size_t extruder) const { return !suspended_ && advance.has(extruder); }
  // The filament of this extruder follows X and Y, of which one is shaped at least.
  bool in_step(size_t extruder) const {
    return !suspended_ && extruder < shaper.in_step.size() && shaper.in_step[extruder] &&
           plane_is_shaped_;
  }
  // Axes have different kernels, so the sum of their speeds differs from the plan.
  bool differ() const { return differ_; }
  // See DriveGaps::share.
  double share(const double* row) const { return suspended_ ? 0 : gaps.share(row); }
  // Whole ticks, one at least, so that clocks of the plan and of the steps are rounded alike.
  double delay(double hz) const { return on_ ? std::max(std::ceil(before_s_ * hz), 1.0) : 0; }
  // Ticks from the end of a move until the last motor is at rest.
  double memory(double hz) const { return on_ ? delay(hz) + std::ceil(after_s_ * hz) : 0; }

 private:
  bool suspended_ = false;
  // Of the settings above.
  bool on_ = false, differ_ = false, plane_is_shaped_ = false;
  double before_s_ = 0, after_s_ = 0;

  void renew() {
    const Kernel x = kernel(kX), y = kernel(kY), z = kernel(kZ);
    on_ = !suspended_ &&
          std::apply([](const auto&... filters) { return (filters.on() || ...); }, all());
    differ_ = on_ && (x.copies != y.copies || x.copies != z.copies);
    plane_is_shaped_ = x.shaped() || y.shaped();
    before_s_ = after_s_ = 0;
    auto reach = [&](const Kernel& kernel) {
      before_s_ = std::max(before_s_, kernel.before_s());
      after_s_ = std::max(after_s_, kernel.after_s());
    };
    for (const Kernel& of_axis : {x, y, z, kernel(kE)}) reach(of_axis);
    for (int i = 0; i < int(advance.half_s.size()); ++i)
      for (int slot : {int(kX), int(kY), int(kE)})
        if (slot == kE || in_step(size_t(i))) reach(kernel(slot, i));
  }
};

}  // namespace passo
