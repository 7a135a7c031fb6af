#include "bind/bind_height_map.hpp"

#include <nanobind/nanobind.h>

#include <cmath>

namespace passo {

namespace nb = nanobind;

std::shared_ptr<const HeightMap> height_map_of(const std::pair<double, double>& first,
                                               const std::pair<double, double>& spacing,
                                               const Rows& heights, const FadeSpec& fade) {
  if (heights.empty()) return nullptr;
  std::vector<double> all;
  for (const auto& row : heights) {
    if (row.size() != heights[0].size()) throw nb::value_error("rows of heights differ in length");
    for (double z : row)
      if (!(std::fabs(z) < 1e3)) throw nb::value_error("a height is beyond 1000 mm");
    all.insert(all.end(), row.begin(), row.end());
  }
  if (heights.size() < 2 || heights[0].size() < 2)
    throw nb::value_error("heights need two rows of two at least");
  auto [x, y] = first;
  auto [dx, dy] = spacing;
  if (!(std::fabs(x) < 1e6 && std::fabs(y) < 1e6 && dx > 0 && dy > 0))
    throw nb::value_error("heights need a place, and a spacing above 0");
  Fade faded;
  if (fade) {
    auto [start, end, target] = *fade;
    if (!(std::fabs(start) < 1e6 && std::fabs(end) < 1e6 && std::fabs(target) < 1e3))
      throw nb::value_error("a fade needs a start, an end and a target");
    faded = {start, end, target};
  }
  auto map = std::make_shared<HeightMap>(x, y, dx, dy, int(heights[0].size()), int(heights.size()),
                                         std::move(all), faded);
  // Otherwise the nozzle could move down while the program's Z rises.
  if (fade && !(faded.end - faded.start > map->range()))
    throw nb::value_error("a fade must be longer than the heights differ from its target");
  return map;
}

}  // namespace passo
