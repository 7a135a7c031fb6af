// passo._core.StepRecording: plays the recorded stream of another host on the simulated printer.
#include <nanobind/nanobind.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "bind/bind_bytes.hpp"
#include "bind/bind_head_dynamics.hpp"
#include "bind/bind_machine.hpp"
#include "sim/print_quality.hpp"
#include "sim/step_recording.hpp"

namespace nb = nanobind;
using namespace nb::literals;
using namespace passo;
using namespace passo::wire;

namespace {

using Dict = nb::typed<nb::dict, nb::str, nb::any>;
using PlayedMotor = std::tuple<size_t, int64_t, double, double>;
using Played = std::tuple<PrintQuality, double, size_t>;

// Start, end and extreme positions of each actuator on a path.
std::vector<std::array<double, 4>> actuator_ranges(const PrintQuality& quality, const Dict& spec) {
  const auto geometry = geometry_of(spec);
  std::vector<std::array<double, 4>> ranges;
  const std::vector<PathSegment>& path = quality.path();
  if (path.empty()) return ranges;
  for (int i = 0; i < geometry->actuators(); ++i) {
    const double first = geometry->inverse(i, path.front().from);
    std::array<double, 4> range{first, geometry->inverse(i, path.back().to), first, first};
    for (const PathSegment& segment : path) {
      const double q = geometry->inverse(i, segment.to);
      range[2] = std::min(range[2], q);
      range[3] = std::max(range[3], q);
    }
    ranges.push_back(range);
  }
  return ranges;
}

Played measure(const StepRecording& recording, const PrintQuality& by, double clock_hz,
               const Dict& spec, const std::array<MassPair, 3>& masses,
               const std::vector<double>& nozzles, const std::vector<PlayedMotor>& motors,
               std::optional<size_t> corner) {
  std::vector<TrackedMotor> tracked;
  std::vector<double> start;
  std::vector<std::vector<StepRun>> runs;
  double first = kInfinity, last = 0;
  size_t commands = 0;
  std::shared_ptr<const Geometry> geometry = geometry_of(spec);
  positive(clock_hz, "clock_hz");
  for (const auto& [index, steps, per_step, at] : motors) {
    tracked.push_back(motor_of(per_step, 1, 0));
    if (int(start.size()) < geometry->actuators()) {
      start.push_back(finite(at, "a position"));
      runs.push_back(recording.last(index, steps));
    } else {  // an extruder: pressure advance moves it too, so only clocks are read
      if (first == kInfinity) break;
      runs.push_back(recording.since(index, Ticks(first - clock_hz)));
    }
    commands += runs.back().size();
    if (runs.back().empty()) continue;
    first = std::min(first, double(runs.back().front().start));
    last = std::max(last, double(runs.back().back().end));
  }
  if (first == kInfinity) throw nb::value_error("its actuators make no steps");
  auto head = std::make_shared<HeadDynamics>(clock_hz, std::move(geometry), masses_of(masses),
                                             nozzles_of(nozzles), tracked);
  nb::gil_scoped_release released;
  head->place(first - clock_hz, start);
  head->run(first - clock_hz);
  for (size_t i = 0; i < runs.size(); ++i) head->add_steps(i, runs[i]);
  PrintQuality quality(clock_hz, head);
  if (corner) quality.show(*corner);
  quality.add_path(by.path());
  quality.begin(first - clock_hz);
  quality.run(last + 0.3 * clock_hz);
  quality.finish();
  return {std::move(quality), (last - first) / clock_hz, commands};
}

}  // namespace

void bind_step_recording(nb::module_& m) {
  m.def("actuator_ranges", &actuator_ranges, "quality"_a, "geometry"_a,
        "For each actuator, on a path that was kept: first and last, lowest and highest position, "
        "mm or degrees.");
  nb::class_<StepRecording>(m, "StepRecording",
                            "The steps of a recorded stream of commands for one board.")
      .def(
          "__init__",
          [](StepRecording* self, const Formats& commands, const nb::bytes& data) {
            new (self) StepRecording(commands, data_of(data), data.size());
          },
          "commands"_a, "data"_a, "Raises ValueError if `data` is not a stream of `commands`.")
      .def_prop_ro(
          "motors",
          [](const StepRecording& r) {
            std::vector<std::pair<uint32_t, int64_t>> motors;
            for (const StepRecording::Motor& motor : r.motors())
              motors.emplace_back(motor.step_pin, motor.steps);
            return motors;
          },
          "The step pin and the number of steps of each motor, in the order of their "
          "configuration.")
      .def(
          "range",
          [](const StepRecording& r, size_t motor, int64_t steps) {
            const StepRecording::Range range = StepRecording::range_of(r.last(motor, steps));
            return std::tuple(range.net, range.lowest, range.highest);
          },
          "motor"_a, "steps"_a,
          "Net steps, lowest and highest count within the last `steps` steps of a motor, from "
          "where these begin.")
      .def("measure", &measure, "quality"_a, "clock_hz"_a, "geometry"_a, "masses"_a, "nozzles"_a,
           "motors"_a, "corner"_a.none(),
           "Plays the stream on a printer without boards, and measures it by the path that "
           "`quality` has kept. `motors` are those of the actuators and then those of the "
           "extruders: index, number of last steps that count, mm or degrees per step, position "
           "before these; an extruder counts from 1 s before the actuators on. Returns the "
           "measurement, the duration in s, and the number of commands.");
}
