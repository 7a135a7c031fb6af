// Pressure advance of the extruders. Each move has its own advance in s (Move::advance).
#pragma once
#include <algorithm>
#include <array>
#include <vector>

#include "machine/filters/kernel.hpp"

namespace passo {

// Above the speed `mm_s` of filament, additional speed counts with the fraction `share` of the
// advance.
struct Knee {
  double mm_s, share;  // share: 0 to 1, at most that of the knee before
};

struct PressureAdvance {
  std::vector<double> half_s;  // for each extruder, half the width over which its advance is
                               // averaged; 0: no advance
  std::vector<std::vector<Knee>>
      knees;  // for each extruder, ascending; none: advance in proportion to speed

  bool on() const {
    return std::any_of(half_s.begin(), half_s.end(), [](double s) { return s > 0; });
  }
  bool has(size_t extruder) const { return extruder < half_s.size() && half_s[extruder] > 0; }
  // The advance is averaged by a triangle. If all axes are averaged over more than half its width,
  // the box of the axes replaces one of the triangle's two boxes.
  void apply(Kernel& kernel, int, int extruder) const {
    if (extruder < 0 || !has(size_t(extruder))) return;
    kernel.narrow_s = half_s[size_t(extruder)];
    kernel.wide_s = std::max(kernel.narrow_s, kernel.box_s);
  }

  static auto settings() {
    using Advance = PressureAdvance;
    return std::array<Setting<Advance>, 2>{{
        {"smooth_s",
         [](Advance& f, size_t e, const Numbers& n) { at_extruder(f.half_s, e) = only(n); }},
        {"knees",
         [](Advance& f, size_t e, const Numbers& n) {
           std::vector<Knee>& knees = at_extruder(f.knees, e);
           knees.clear();
           for (size_t i = 0; i + 1 < n.size(); i += 2) knees.push_back({n[i], n[i + 1]});
         }},
    }};
  }
};

}  // namespace passo
