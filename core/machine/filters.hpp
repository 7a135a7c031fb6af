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

// A filter may need positions that come later in the plan. Every motor follows the plan with a
// delay, so that these positions are known. A cut of the plan and of the steps is at one clock.
class Filters {
 public:
  // The filters in the order in which they act. Only set() changes them. A filter that acts on
  // kernels has a function apply(kernel, slot, extruder): for an axis, with extruder -1, or for the
  // filament of an extruder. The slot of filament is kE, or the slot of the axis that the filament
  // follows.
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
  // All filters are off during homing and probing.
  void suspend(bool suspended) {
    suspended_ = suspended;
    renew();
  }

  bool on() const { return on_; }
  // The kernel of all filters for a slot. `extruder`: for its filament that follows this slot.
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
  // Whether the filament of this extruder follows X and Y. Only if at least one of them is shaped.
  bool in_step(size_t extruder) const {
    return !suspended_ && extruder < shaper.in_step.size() && shaper.in_step[extruder] &&
           plane_is_shaped_;
  }
  // Whether axes have different kernels. Then the speed along the path differs from the plan.
  bool differ() const { return differ_; }
  // See DriveGaps::share.
  double share(const double* row) const { return suspended_ ? 0 : gaps.share(row); }
  // Delay of the motors in ticks: an integer and at least 1, so that clocks of the plan and of the
  // steps are rounded in the same way.
  double delay(double hz) const { return on_ ? std::max(std::ceil(before_s_ * hz), 1.0) : 0; }
  // Ticks from the end of a move until all motors are at standstill.
  double memory(double hz) const { return on_ ? delay(hz) + std::ceil(after_s_ * hz) : 0; }

 private:
  bool suspended_ = false;
  // Calculated by renew().
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
