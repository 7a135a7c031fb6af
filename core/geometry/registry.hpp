// Makes a geometry by its name in the configuration.
#pragma once
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "geometry/geometry.hpp"

namespace passo {

using GeometryParams = std::map<std::string, std::vector<double>>;

// The parameter `skew`, three factors as in skewed.hpp, may be missing.
// Throws std::out_of_range for a missing parameter, std::invalid_argument for an unknown kind.
std::unique_ptr<Geometry> make_geometry(const std::string& kind, const GeometryParams& params);

}  // namespace passo
