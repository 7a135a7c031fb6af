// A limit of jerk: the position of each axis and of the filament is averaged over a time. The jerk
// of an axis is then its change of acceleration within this time, divided by the time.
#pragma once
#include <array>

#include "machine/filters/kernel.hpp"

namespace passo {

struct JerkLimit {
  double box_s = 0;  // 0: no limit

  bool on() const { return box_s > 0; }
  void apply(Kernel& kernel, int, int) const { kernel.box_s = box_s; }

  static auto settings() {
    return std::array<Setting<JerkLimit>, 1>{{
        {"box_s", [](JerkLimit& f, size_t, const Numbers& n) { f.box_s = only(n); }},
    }};
  }
};

}  // namespace passo
