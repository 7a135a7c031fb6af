// Python interface of a planned move.
#pragma once
#include <nanobind/nanobind.h>
#include <nanobind/stl/tuple.h>

#include <tuple>

#include "plan/move.hpp"

namespace passo {

inline void bind_move(nanobind::module_& m) {
  namespace nb = nanobind;
  auto positions = [](const double* p) {
    return std::make_tuple(p[0], p[1], p[2], p[3], p[4], p[5], p[6], p[7]);
  };
  nb::class_<Move>(
      m, "Move",
      "A planned move: a line with a trapezoid of speed. Speeds are of the path measure.")
      .def_prop_ro(
          "start_mm", [=](const Move& x) { return positions(x.p0); }, "X, Y, Z, E and further axes")
      .def_prop_ro("end_mm", [=](const Move& x) { return positions(x.p1); })
      .def_ro("length", &Move::d, "path measure, usually mm")
      .def_ro("start_speed", &Move::v0)
      .def_ro("cruise_speed", &Move::vc)
      .def_ro("end_speed", &Move::v1)
      .def_ro("acceleration", &Move::a, "of the first phase, signed")
      .def_ro("deceleration", &Move::b, "of the last phase, positive")
      .def_prop_ro("speed_cap", [](const Move& x) { return std::sqrt(x.vn2); })
      .def_ro("advance_s", &Move::advance, "pressure advance of its filament")
      .def_prop_ro(
          "advance_binds", [](const Move& x) { return x.advance_binds; },
          "The speed at its start is bound by what the advance asks of the extruder.")
      .def_prop_ro(
          "start_cap", [](const Move& x) { return std::sqrt(x.vj2); }, "junction's speed limit")
      .def_ro("accelerate_length", &Move::d_acc)
      .def_ro("cruise_length", &Move::d_cru)
      .def_ro("start_ticks", &Move::start)
      .def_ro("accelerate_ticks", &Move::t_acc)
      .def_ro("cruise_ticks", &Move::t_cru)
      .def_ro("decelerate_ticks", &Move::t_dec)
      .def_prop_ro("end_ticks", [](const Move& x) { return x.end(); })
      .def_ro("line", &Move::line)
      .def_ro("layer", &Move::layer)
      .def_ro("feature", &Move::feature)
      .def_ro("extruder", &Move::extruder)
      .def_ro("inner", &Move::inner, "continues the path of the move before it")
      .def_ro("tolerance_ticks", &Move::tolerance,
              "by which its steps may miss their ideal times; 0: the board's own")
      .def_ro("speed_limit", &Move::speed_limit, "index in the names of limits")
      .def_ro("accel_limit", &Move::accel_limit)
      .def_prop_ro("kind", [](const Move& x) {
        const char* names[] = {"travel", "print", "extrude", "dwell"};
        return names[int(x.kind)];
      });
}

}  // namespace passo
