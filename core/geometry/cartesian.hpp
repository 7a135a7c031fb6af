// Cartesian: one actuator for each axis.
#pragma once
#include "geometry/linear.hpp"

namespace passo {

inline LinearGeometry cartesian() {
  return LinearGeometry({{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
}

}  // namespace passo
