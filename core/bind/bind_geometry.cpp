// passo._core.Geometry: each function of a geometry, and the core's own trigonometry.
#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <optional>
#include <tuple>

#include "base/numbers.hpp"
#include "bind/bind_machine.hpp"

namespace nb = nanobind;
using namespace nb::literals;
using namespace passo;

namespace {

using Point = std::tuple<double, double, double>;

struct GeometryView {
  std::unique_ptr<Geometry> geometry;
};
struct Array {
  double p[3];
  explicit Array(const Point& x) : p{std::get<0>(x), std::get<1>(x), std::get<2>(x)} {}
};
int checked(const GeometryView& self, int i) {
  if (i < 0 || i >= self.geometry->actuators()) throw nb::index_error("no such actuator");
  return i;
}
Path path_of(const Point& from, const Point& to) {
  Array a(from), b(to);
  Path path{{a.p[0], a.p[1], a.p[2]}, {b.p[0], b.p[1], b.p[2]}, 0};
  double dx = b.p[0] - a.p[0], dy = b.p[1] - a.p[1], dz = b.p[2] - a.p[2];
  path.length = std::sqrt(dx * dx + dy * dy + dz * dz);
  if (!(path.length > 0)) throw nb::value_error("a path needs a length");
  return path;
}

}  // namespace

void bind_geometry(nb::module_& m) {
  m.def(
      "sincos",
      [](double x) {
        double s, c;
        sincos(x, s, c);
        return std::make_tuple(s, c);
      },
      "x"_a);
  m.def("atan2", [](double y, double x) { return passo::atan2(y, x); }, "y"_a, "x"_a);
  nb::class_<GeometryView>(m, "Geometry",
                           "A geometry kernel: Cartesian mm to actuator mm or degrees, and back.")
      .def(
          "__init__",
          [](GeometryView* self, const nb::dict& spec) {
            new (self) GeometryView{geometry_of(spec)};
          },
          "spec"_a)
      .def_prop_ro("actuators", [](const GeometryView& self) { return self.geometry->actuators(); })
      .def(
          "inverse",
          [](const GeometryView& self, int i, const Point& p) {
            return self.geometry->inverse(checked(self, i), Array(p).p);
          },
          "actuator"_a, "point"_a, "Position of an actuator; NaN if it cannot reach the point.")
      .def(
          "forward",
          [](const GeometryView& self, const std::vector<double>& q) {
            double p[3];
            if (int(q.size()) != self.geometry->actuators())
              throw nb::value_error("one position for each actuator");
            if (!self.geometry->forward(q.data(), p))
              throw nb::value_error("no nozzle position belongs to these");
            return Point(p[0], p[1], p[2]);
          },
          "positions"_a, "Nozzle position. Raises ValueError if no position fits.")
      .def(
          "linear",
          [](const GeometryView& self, int i) -> std::optional<Point> {
            double c[3];
            if (!self.geometry->linear(checked(self, i), c)) return std::nullopt;
            return Point(c[0], c[1], c[2]);
          },
          "actuator"_a,
          "The distance that an actuator moves per mm of X, Y and Z; None if it depends on the "
          "position.")
      .def(
          "slopes",
          [](const GeometryView& self, int i, const Point& from, const Point& to, double s) {
            double d1, d2;
            self.geometry->slopes(checked(self, i), path_of(from, to), s, d1, d2);
            return std::make_tuple(d1, d2);
          },
          "actuator"_a, "start"_a, "end"_a, "s"_a,
          "First and second derivative by path length at s mm.")
      .def(
          "crossings",
          [](const GeometryView& self, int i, const Point& from, const Point& to, double per_unit) {
            Crossings out;
            self.geometry->crossings(checked(self, i), path_of(from, to), per_unit, out);
            std::vector<int> dirs(out.s.size());
            for (size_t r = 0; r < out.runs.size(); ++r)
              for (size_t k = size_t(out.runs[r].first); k < dirs.size(); ++k)
                dirs[k] = out.runs[r].dir;
            return std::make_tuple(out.s, dirs);
          },
          "actuator"_a, "start"_a, "end"_a, "steps_per_unit"_a,
          "Path positions and directions of all steps of a nonlinear actuator along a line.");
}
