// Heights of the bed from Python → HeightMap.
#pragma once
#include <memory>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "machine/height_map.hpp"

namespace passo {

using Rows = std::vector<std::vector<double>>;
using FadeSpec = std::optional<std::tuple<double, double, double>>;  // start, end, target

// Null without rows: the bed is flat. Throws nanobind::value_error.
std::shared_ptr<const HeightMap> height_map_of(const std::pair<double, double>& first,
                                               const std::pair<double, double>& spacing,
                                               const Rows& heights, const FadeSpec& fade);

inline constexpr char kHeightMapText[] =
    "What the bed adds to Z: heights in mm on an even grid, rows along X, the first one at the Y "
    "of "
    "`first`; bilinear in between, level beyond. With a `fade` of start, end and target, mm: in "
    "full up to the start in Z, then evenly less, until the target alone is added from the end on. "
    "No rows: the bed is flat. No motor moves, but Z of the plan changes; only while nothing is "
    "queued. Raises ValueError.";

}  // namespace passo
