// The results of a job: records of moves, path and ideal step times, and statistics.
#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "bind/bind_job.hpp"

namespace nb = nanobind;
using namespace nb::literals;
using namespace passo;

namespace {

using Table = nb::typed<nb::dict, nb::str, nb::any>;

nb::typed<nb::dict, nb::str, nb::float_> cpu(const ResultsPart& self) {
  const Job& job = self.job;
  nb::dict d;
  d["parse"] = job.cpu_parse;
  d["plan"] = job.cpu_plan;
  d["steps"] = job.motion.cpu().steps;
  d["compress"] = job.motion.cpu().compress;
  return nb::typed<nb::dict, nb::str, nb::float_>(d);
}

Table statistics(ResultsPart& self) {
  Job& job = self.job;
  const PlanStatistics& plan = job.motion.plan();
  const Machine& machine = job.motion.machine();
  nb::dict d, limits, features;
  d["lines"] = job.interpreter.line();
  d["moves"] = plan.moves;
  d["arcs"] = job.interpreter.arcs();
  d["move_s"] = plan.move_s;
  d["dwell_s"] = plan.dwell_s;
  d["travel_mm"] = plan.travel_mm;
  d["print_mm"] = plan.print_mm;
  d["filament_mm"] = plan.filament_mm;
  d["layers"] = job.interpreter.layers.count();
  d["layer_s"] = plan.layer_s;
  const auto& names = job.motion.planner().constraints().names;
  for (size_t i = 0; i < plan.limit_s.size(); ++i)
    if (plan.limit_s[i] > 0) limits[names[i].c_str()] = plan.limit_s[i];
  d["limit_s"] = limits;
  nb::dict loads;
  auto exceed = [&](const char* name, const PlanStatistics::Load& load) {
    if (load.share > 1) loads[name] = std::make_tuple(load.line, load.share, load.budget);
  };
  exceed("steps", plan.most_steps);
  exceed("commands", plan.most_commands);
  d["loads"] = loads;
  nb::dict densest;
  auto peak = [](const PlanStatistics::Peak& p) { return std::make_tuple(p.line, p.most); };
  auto put = [&](const char* name, const PlanStatistics::Peak* p) {
    std::vector<std::tuple<uint32_t, double>> found;
    for (size_t i = 0; i < machine.budgets.size(); ++i) found.push_back(peak(p[i]));
    densest[name] = found;
  };
  put("steps_s", plan.steps_s);
  put("commands_s", plan.commands_s);
  densest["ahead"] = peak(plan.ahead);
  d["densest"] = densest;
  d["widened_s"] = plan.widened_s;
  d["widest_ticks"] = plan.widest_ticks;
  for (size_t i = 0; i < plan.feature_s.size(); ++i) {
    if (plan.feature_s[i] <= 0) continue;
    const std::string& name = job.interpreter.features()[i];
    features[name.empty() ? "other" : name.c_str()] = plan.feature_s[i];
  }
  d["feature_s"] = features;
  std::vector<double> position;
  for (size_t i = 0; i < machine.axes.size(); ++i)
    position.push_back(job.motion.planner().position()[slot_of_axis(int(i))]);
  for (size_t i = 0; i < machine.extruders.size(); ++i)
    position.push_back(job.motion.planner().extruder_position(i));
  d["position_mm"] = position;
  return Table(d);
}

using LayerTuple = std::tuple<uint32_t, double, double, uint16_t>;
using ToolpathTuple =
    std::tuple<uint32_t, std::vector<double>, double, double, std::vector<LayerTuple>, nb::bytes>;

std::optional<ToolpathTuple> take_toolpath(ResultsPart& self) {
  if (!self.view.toolpath) return std::nullopt;
  const Toolpath path = *std::exchange(self.view.toolpath, std::nullopt);
  self.view.watch_moves();
  const Toolpath::Scale scale = path.scale();
  std::vector<LayerTuple> layers;
  for (const Toolpath::Layer& layer : path.layers())
    layers.emplace_back(layer.row, layer.z_mm, layer.start_s, layer.number);
  const std::string data = path.encoded();
  return ToolpathTuple(uint32_t(path.rows()), {scale.origin, scale.origin + 3}, scale.unit_mm,
                       path.end_s(), std::move(layers), nb::bytes(data.data(), data.size()));
}

using PartTuple = std::tuple<double, double, double, double, double, double>;

std::vector<PartTuple> law(const ResultsPart& self, int slot, bool filtered) {
  if (slot != kX && slot != kY && slot != kE) throw nb::index_error("X, Y or E");
  if (!self.view.fastest_corner || !self.view.fastest_corner->found())
    throw nb::value_error("no corner is kept");
  const double hz = self.job.motion.machine().clock_hz;
  std::vector<PartTuple> parts;
  for (const FastestCorner::Part& p : self.view.fastest_corner->law(slot, filtered))
    parts.emplace_back(p.start / hz, p.ticks / hz, p.q, p.v * hz, p.a * hz * hz,
                       p.j * hz * hz * hz);
  return parts;
}

}  // namespace

void bind_job_results(nb::module_& m, JobClass& job) {
  bind_part<ResultsPart>(m, job, "JobResults", "results", "Records of the plan, and statistics.")
      .def(
          "keep_moves",
          [](ResultsPart& self, bool on) {
            self.view.keeps_moves = on;
            self.view.watch_moves();
          },
          "on"_a, "With `on`, records the settled moves, see take_moves.")
      .def(
          "take_moves", [](ResultsPart& self) { return std::exchange(self.view.moves, {}); },
          "Returns the moves settled since the last call, in order.")
      .def(
          "keep_toolpath",
          [](ResultsPart& self) {
            self.view.toolpath.emplace(self.job.motion.machine().clock_hz);
            self.view.watch_moves();
          },
          "From now on records the path of all moves.")
      .def("take_toolpath", &take_toolpath,
           "Returns the recorded path in the format of toolpath.py, or None without one. Ends "
           "the recording.")
      .def(
          "keep_corner",
          [](ResultsPart& self) {
            self.view.fastest_corner.emplace(self.job.motion.machine());
            self.view.watch_moves();
          },
          "From now on keeps the moves around the fastest corner of filtered motion.")
      .def_prop_ro(
          "corner",
          [](const ResultsPart& self)
              -> std::optional<std::tuple<uint32_t, double, double, double>> {
            if (!self.view.fastest_corner || !self.view.fastest_corner->found())
              return std::nullopt;
            const FastestCorner& corner = *self.view.fastest_corner;
            const double hz = self.job.motion.machine().clock_hz;
            return std::make_tuple(corner.line(), corner.at_mm()[0], corner.at_mm()[1],
                                   corner.clock() / hz);
          },
          "That corner, at the end of the job: the line in the file of the move after it, X and Y "
          "in mm, and the print time in s at which the motors pass it. None if no motion was "
          "filtered.")
      .def("corner_law", &law, "slot"_a, "filtered"_a,
           "The position of X (0), Y (1) or E (3) around that corner, with the filters or as "
           "planned and then delayed like all motors: parts without gaps, each its start and "
           "duration in s, and at its start position, speed, acceleration and jerk in mm and s. "
           "The jerk of a part is constant.")
      .def(
          "keep_ideal",
          [](ResultsPart& self, bool on) {
            for (size_t i = 0; i < self.job.motion.machine().steppers.size(); ++i)
              self.job.motion.stream().compressor(i).keep_ideal(on);
          },
          "on"_a, "From now on records the ideal time of every step, see take_ideal.")
      .def(
          "take_ideal",
          [](ResultsPart& self, size_t stepper) {
            if (stepper >= self.job.motion.machine().steppers.size())
              throw nb::index_error("no such stepper");
            std::vector<double>& ideal = self.job.motion.stream().compressor(stepper).ideal();
            nb::bytes bytes(reinterpret_cast<const char*>(ideal.data()),
                            ideal.size() * sizeof(double));
            ideal.clear();
            return bytes;
          },
          "stepper"_a, "Ideal ticks (float64) of the steps made into commands since the last call.")
      .def("statistics", &statistics, "Totals of the plan by name.")
      .def("cpu", &cpu, "Processor time in s of each part of the planning.");
}
