// Converts the heights of a bed from Python to a HeightMap.
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

// Returns null if there are no rows: the bed is flat. Throws nanobind::value_error.
std::shared_ptr<const HeightMap> height_map_of(const std::pair<double, double>& first,
                                               const std::pair<double, double>& spacing,
                                               const Rows& heights, const FadeSpec& fade);

inline constexpr char kHeightMapText[] =
    "Sets the bed correction: heights in mm on an even grid. Rows are along X; the first row is at "
    "the Y of `first`. Between the points the height is bilinear; beyond the grid it continues "
    "level. With a `fade` of start, end and target in mm, the correction acts in full up to Z "
    "start, and changes linearly to the target at Z end. Without rows the bed is flat. No motor "
    "moves, but Z of the plan changes. Call it only while nothing is queued. Raises ValueError.";

}  // namespace passo
