// The settings of a job: bed correction, motion filters, filament, limits.
#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <iterator>
#include <memory>
#include <tuple>

#include "bind/bind_height_map.hpp"
#include "bind/bind_job.hpp"
#include "bind/bind_machine.hpp"

namespace nb = nanobind;
using namespace nb::literals;
using namespace passo;

namespace {

double* place_of(Limits& l, const std::string& name) {
  double* places[] = {
      &l.print_accel,        &l.travel_accel,  &l.retract_accel,        &l.speed,
      &l.junction_deviation, &l.square_corner, &l.minimum_cruise_ratio, &l.least_speed_gain};
  const char* names[] = {
      "print_accel",        "travel_accel",  "retract_accel",        "speed",
      "junction_deviation", "square_corner", "minimum_cruise_ratio", "least_speed_gain"};
  for (size_t i = 0; i < std::size(names); ++i)
    if (name == names[i]) return places[i];
  throw nb::key_error(name.c_str());
}

double Row::* place_of(const std::string& what) {
  if (what == "speed") return &Row::speed;
  if (what == "accel") return &Row::accel;
  if (what == "jerk") return &Row::jerk;
  throw nb::key_error(what.c_str());
}

void check_extruder(const JobPart& self, size_t extruder) {
  if (extruder >= self.job.motion.machine().extruders.size())
    throw nb::index_error("no such extruder");
}

void check_flow(const JobPart& self, size_t extruder, double flow) {
  check_extruder(self, extruder);
  if (!(flow > 0 && flow < kInfinity)) throw nb::value_error("a flow must be above 0");
}

}  // namespace

void bind_job_settings(nb::module_& m, JobClass& job) {
  bind_part<BedPart>(m, job, "JobBed", "bed", "The bed correction.")
      .def(
          "set_height_map",
          [](BedPart& self, const std::pair<double, double>& first,
             const std::pair<double, double>& spacing, const Rows& heights, const FadeSpec& fade) {
            auto map = height_map_of(first, spacing, heights, fade);
            self.job.set_height_map(std::move(map));
          },
          "first"_a, "spacing"_a, "heights"_a, "fade"_a = nb::none(), kHeightMapText)
      .def(
          "follow_tool", [](BedPart& self) { self.job.follow_tool(); },
          "The correction of Z is that at the place of the tool in use, from standstill on; the "
          "next move goes to the Z that the program means.")
      .def_prop_ro(
          "is_apart", [](BedPart& self) { return self.job.bed_is_apart(); },
          "Whether the correction of Z is that at the place of another tool.")
      .def(
          "plan_z",
          [](BedPart& self, double x, double y, double height) {
            return self.job.motion.machine().plan_z(x, y, height);
          },
          "x"_a, "y"_a, "height"_a,
          "The Z of the plan, in mm, at which the corrected nozzle is at this height.")
      .def(
          "nozzle_height",
          [](BedPart& self, double x, double y, double z) {
            const double p[] = {x, y, z};
            return self.job.motion.machine().raised(p);
          },
          "x"_a, "y"_a, "z"_a, "The Z of the plan plus the bed correction there, in mm.");

  bind_part<FiltersPart>(m, job, "JobFilters", "filters", "The motion filters.")
      .def(
          "set",
          [](FiltersPart& self, const std::string& name, size_t index, const Numbers& numbers) {
            self.job.motion.flush();
            self.job.motion.set_filter(name, index, numbers);
          },
          "name"_a, "index"_a, "numbers"_a,
          "Changes a setting of a motion filter (core/machine/filters/) for one axis or extruder, "
          "0 for a setting of the machine: its name and numbers, as in the machine's description, "
          "without brackets between them. Call it only at standstill.")
      .def(
          "use",
          [](FiltersPart& self, bool on) {
            self.job.motion.flush();
            self.job.motion.use_filters(on);
          },
          "on"_a, "Switches all motion filters on or off. Call it only at standstill.")
      .def(
          "set_advance",
          [](FiltersPart& self, size_t extruder, double seconds) {
            check_extruder(self, extruder);
            self.job.motion.planner().advance[extruder] = seconds;
          },
          "extruder"_a, "seconds"_a, "Sets the pressure advance of later moves.")
      .def(
          "advance",
          [](FiltersPart& self, size_t extruder) {
            check_extruder(self, extruder);
            return self.job.motion.planner().advance[extruder];
          },
          "extruder"_a, "The pressure advance of an extruder, s.")
      .def_prop_ro(
          "delay_s",
          [](FiltersPart& self) {
            const Motion& motion = self.job.motion;
            return motion.delay() / motion.machine().clock_hz;
          },
          "The delay of all motors relative to the plan, s, in whole ticks.");

  bind_part<FilamentPart>(m, job, "JobFilament", "filament",
                          "What scales and limits the motion of filament.")
      .def_prop_rw(
          "cold", [](FilamentPart& self) { return bool(self.job.interpreter.cold >> kE & 1); },
          [](FilamentPart& self, bool cold) {
            uint8_t& slots = self.job.interpreter.cold;
            slots = uint8_t(cold ? slots | 1u << kE : slots & ~(1u << kE));
          },
          "While it is set, moves of the tool's filament are errors.")
      .def(
          "set_cold_axis",
          [](FilamentPart& self, int axis, bool cold) {
            if (axis < 3 || size_t(axis) >= self.job.motion.machine().axes.size())
              throw nb::index_error("no such further axis");
            uint8_t &slots = self.job.interpreter.cold, bit = uint8_t(1u << slot_of_axis(axis));
            slots = uint8_t(cold ? slots | bit : slots & ~bit);
          },
          "axis"_a, "cold"_a, "The same for an axis, by number, that moves filament.")
      .def_prop_ro(
          "scale", [](FilamentPart& self) { return self.job.interpreter.e_scale(); },
          "mm of filament of the tool in use for a mm, or mm3, of the program's E.")
      .def_prop_ro(
          "flows",
          [](FilamentPart& self) {
            std::vector<double> flows;
            for (size_t i = 0; i < self.job.motion.machine().extruders.size(); ++i)
              flows.push_back(self.job.interpreter.flow(i));
            return flows;
          },
          "M221 of each extruder, as a factor.")
      .def(
          "set_flow",
          [](FilamentPart& self, size_t extruder, double flow) {
            check_flow(self, extruder, flow);
            self.job.interpreter.set_flow(extruder, flow);
          },
          "extruder"_a, "flow"_a, "M221, a factor above 0, for moves that are read from now on.")
      .def(
          "scale_flow_from",
          [](FilamentPart& self, double ticks, size_t extruder, double flow) {
            check_flow(self, extruder, flow);
            return self.job.scale_flow_from(ticks, extruder, flow);
          },
          "ticks"_a, "extruder"_a, "flow"_a,
          "M221, a factor above 0, for all moves after this clock, planned or not yet read. "
          "Returns the clock of the cut.")
      .def_prop_ro(
          "width_factors",
          [](FilamentPart& self) {
            std::vector<double> factors;
            for (size_t i = 0; i < self.job.motion.machine().extruders.size(); ++i)
              factors.push_back(self.job.interpreter.width_factor(i));
            return factors;
          },
          "The factor of the measured width of each filament.")
      .def(
          "scale_width_from",
          [](FilamentPart& self, double ticks, size_t extruder, double width) {
            check_flow(self, extruder, width);
            return self.job.scale_width_from(ticks, extruder, width);
          },
          "ticks"_a, "extruder"_a, "width"_a,
          "The factor of the measured width of the filament, above 0, like scale_flow_from. The "
          "flow is the product of this factor and that of M221.")
      .def_prop_ro(
          "diameters",
          [](FilamentPart& self) -> std::optional<std::vector<double>> {
            const Interpreter& i = self.job.interpreter;
            if (!i.volumetric()) return std::nullopt;
            return i.diameters();
          },
          "The filament diameter of each extruder in mm if E is a volume (M200); otherwise None.")
      .def_prop_ro(
          "changes",
          [](FilamentPart& self) {
            std::vector<std::pair<double, double>> lengths;
            for (const auto& c : self.job.interpreter.changes())
              lengths.emplace_back(c.load_mm, c.unload_mm);
            return lengths;
          },
          "The lengths in mm that M701 loads and M702 unloads, of each extruder.");

  bind_part<LimitsPart>(m, job, "JobLimits", "limits", "The limits of moves, and the speed factor.")
      .def(
          "value",
          [](LimitsPart& self, const std::string& name) {
            Limits limits = self.job.motion.planner().rules().now().limits;
            return *place_of(limits, name);
          },
          "name"_a, "The value of a limit, named as in `set`.")
      .def(
          "set",
          [](LimitsPart& self, const std::string& name, double value, bool live) {
            self.job.motion.planner().rules().change(
                live, [&](Rules& r) { *place_of(r.limits, name) = value; });
          },
          "name"_a, "value"_a, "live"_a = false,
          "Changes a limit for later moves; with `live`, also for moves that are planned again.")
      .def(
          "of_axis",
          [](LimitsPart& self, const std::string& axis, const std::string& what) {
            const Constraints& c = self.job.motion.planner().constraints();
            const Machine& m = self.job.motion.machine();
            for (size_t i = 0; i < m.axes.size(); ++i)
              if (m.axes[i].name == axis) return c.rows[i].*place_of(what);
            for (size_t i = 0; i < m.extruders.size(); ++i)
              if (m.extruders[i].name == axis) return c.extruders[i].*place_of(what);
            throw nb::key_error(axis.c_str());
          },
          "axis"_a, "what"_a, "The `speed`, `accel` or `jerk` of an axis or extruder now.")
      .def(
          "set_of_axis",
          [](LimitsPart& self, const std::string& axis, const std::string& what, double value,
             bool live) {
            self.job.motion.planner().rules().change(live, [&](Rules& r) {
              auto changed = std::make_shared<Constraints>(*r.constraints);
              changed->set(self.job.motion.machine(), axis, place_of(what), value);
              r.constraints = std::move(changed);
            });
          },
          "axis"_a, "what"_a, "value"_a, "live"_a = false,
          "Changes the `speed`, `accel` or `jerk` of an axis like `set`, at most to the "
          "machine's own limit.")
      .def_prop_ro(
          "names", [](LimitsPart& self) { return self.job.motion.planner().constraints().names; },
          "The names of all limits of a move, in the order of their numbers.")
      .def_prop_ro(
          "speed_factor",
          [](LimitsPart& self) { return self.job.motion.planner().rules().now().speed_factor; },
          "M220, as a factor.")
      .def(
          "set_speed_factor",
          [](LimitsPart& self, double factor, bool live) {
            self.job.motion.planner().rules().change(live,
                                                     [&](Rules& r) { r.speed_factor = factor; });
          },
          "factor"_a, "live"_a = false,
          "M220 for later moves; with `live`, also for moves that are planned again from now on.");
}
