#include "geometry/registry.hpp"

#include <algorithm>
#include <stdexcept>

#include "geometry/cartesian.hpp"
#include "geometry/core_belts.hpp"
#include "geometry/delta.hpp"
#include "geometry/deltesian.hpp"
#include "geometry/dual_scara.hpp"
#include "geometry/motionless.hpp"
#include "geometry/polar.hpp"
#include "geometry/rotary_delta.hpp"
#include "geometry/scara.hpp"
#include "geometry/skewed.hpp"
#include "geometry/winch.hpp"

namespace passo {

namespace {

std::unique_ptr<Geometry> rectangular(const std::string& kind, const GeometryParams& params) {
  auto list = [&](const char* name) -> const std::vector<double>& { return params.at(name); };
  auto number = [&](const char* name) { return params.at(name).at(0); };
  if (kind == "cartesian") return std::make_unique<LinearGeometry>(cartesian());
  if (kind == "corexy") return std::make_unique<LinearGeometry>(core_xy());
  if (kind == "corexz") return std::make_unique<LinearGeometry>(core_xz());
  if (kind == "coreyz") return std::make_unique<LinearGeometry>(core_yz());
  if (kind == "hybrid_corexy") return std::make_unique<LinearGeometry>(hybrid_core_xy());
  if (kind == "hybrid_corexz") return std::make_unique<LinearGeometry>(hybrid_core_xz());
  if (kind == "delta")
    return std::make_unique<Delta>(number("radius"), list("rods"), list("angles"),
                                   number("limit_radius"));
  if (kind == "deltesian")
    return std::make_unique<Deltesian>(list("towers_x"), list("rods"), number("min_angle"));
  if (kind == "rotary_delta")
    return std::make_unique<RotaryDelta>(number("effector_length"), number("base_length"),
                                         number("rod_length"), number("arm_length"),
                                         number("z_offset"));
  if (kind == "scara")
    return std::make_unique<Scara>(number("arm1"), number("arm2"), number("external_motor") != 0,
                                   number("x_offset"), number("y_offset"), list("middles").at(0),
                                   list("middles").at(1));
  if (kind == "dual_scara")
    return std::make_unique<DualScara>(number("shoulder1_x"), number("shoulder2_x"),
                                       number("proximal1"), number("proximal2"), number("distal1"),
                                       number("distal2"), number("x_offset"), number("y_offset"),
                                       list("middles").at(0), list("middles").at(1));
  if (kind == "polar") return std::make_unique<Polar>(number("centre"));
  if (kind == "winch") return std::make_unique<Winch>(list("anchors"), number("side"));
  if (kind == "none") return std::make_unique<Motionless>();
  throw std::invalid_argument("unknown geometry " + kind);
}

}  // namespace

std::unique_ptr<Geometry> make_geometry(const std::string& kind, const GeometryParams& params) {
  std::unique_ptr<Geometry> axes = rectangular(kind, params);
  const auto skew = params.find("skew");
  if (skew == params.end()) return axes;
  const std::vector<double>& factors = skew->second;
  if (std::all_of(factors.begin(), factors.end(), [](double f) { return f == 0; })) return axes;
  return std::make_unique<Skewed>(std::move(axes), factors.at(0), factors.at(1), factors.at(2));
}

}  // namespace passo
