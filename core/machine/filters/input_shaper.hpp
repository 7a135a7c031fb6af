// Input shapers of X, Y and Z, which cancel vibrations.
#pragma once
#include <array>
#include <vector>

#include "base/types.hpp"
#include "machine/filters/kernel.hpp"

namespace passo {

struct InputShaper {
  std::vector<Impulse> of[3];  // for each axis, ascending from 0 s; empty: no shaper
  std::vector<char> in_step;   // for each extruder: its filament follows the kernels of X and Y

  bool on() const { return !(of[0].empty() && of[1].empty() && of[2].empty()); }
  void apply(Kernel& kernel, int slot, int) const {
    if (slot <= kZ) kernel.convolve(of[slot]);
  }

  static auto settings() {
    using Shaper = InputShaper;
    return std::array<Setting<Shaper>, 2>{{
        {"shapers",
         [](Shaper& f, size_t axis, const Numbers& n) { f.of[axis_of(axis)] = impulses_of(n); }},
        {"shaped",
         [](Shaper& f, size_t e, const Numbers& n) { at_extruder(f.in_step, e) = only(n) != 0; }},
    }};
  }
};

}  // namespace passo
