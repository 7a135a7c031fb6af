// CoreXY, CoreXZ and CoreYZ: two belts move two axes together, A = u + v and B = u - v. Hybrids
// have one such belt, A = u - v, and a motor for v only.
#pragma once
#include "geometry/linear.hpp"

namespace passo {

inline LinearGeometry core_xy() {
  return LinearGeometry({{1, 1, 0}, {1, -1, 0}, {0, 0, 1}},
                        {{0.5, 0.5, 0}, {0.5, -0.5, 0}, {0, 0, 1}});
}
inline LinearGeometry hybrid_core_xy() {
  return LinearGeometry({{1, -1, 0}, {0, 1, 0}, {0, 0, 1}}, {{1, 1, 0}, {0, 1, 0}, {0, 0, 1}});
}
inline LinearGeometry hybrid_core_xz() {
  return LinearGeometry({{1, 0, -1}, {0, 1, 0}, {0, 0, 1}}, {{1, 0, 1}, {0, 1, 0}, {0, 0, 1}});
}
inline LinearGeometry core_xz() {
  return LinearGeometry({{1, 0, 1}, {0, 1, 0}, {1, 0, -1}},
                        {{0.5, 0, 0.5}, {0, 1, 0}, {0.5, 0, -0.5}});
}
inline LinearGeometry core_yz() {
  return LinearGeometry({{1, 0, 0}, {0, 1, 1}, {0, 1, -1}},
                        {{1, 0, 0}, {0, 0.5, 0.5}, {0, 0.5, -0.5}});
}

}  // namespace passo
