// The machine of a job: its axes, motors and tools, and its history.
#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "bind/bind_job.hpp"
#include "bind/bind_machine.hpp"

namespace nb = nanobind;
using namespace nb::literals;
using namespace passo;

namespace {

using Table = nb::typed<nb::dict, nb::str, nb::any>;

nb::typed<nb::list, Table> statistics(MotorsPart& self) {
  nb::typed<nb::list, Table> list;
  Motion& motion = self.job.motion;
  for (size_t i = 0; i < motion.machine().steppers.size(); ++i) {
    const StepStatistics& s = motion.stream().statistics(i);
    nb::dict d;
    d["name"] = motion.machine().steppers[i].name;
    d["steps_per_unit"] = motion.machine().steppers[i].steps_per_unit;
    d["steps"] = s.steps;
    d["net"] = s.net;
    d["count"] = motion.stream().count(i) - motion.stream().lead(i);
    d["taken_up"] = motion.stream().taken_up(i);
    d["expected_net"] = motion.stream().expected_net(i);
    d["commands"] = s.commands;
    d["dropped_pairs"] = s.dropped_pairs;
    d["error_max_ticks"] = s.error_max;
    d["error_square_ticks2"] = s.error_square;
    list.append(d);
  }
  return list;
}

}  // namespace

void bind_job_axes(nb::module_& m, JobClass& job) {
  bind_part<AxesPart>(m, job, "JobAxes", "axes", "The positions of the axes, set without motion.")
      .def(
          "settle", [](AxesPart& self) { self.job.settle_position(); },
          "After homing: ends the plan, and sets the position of the machine to that of the "
          "program.")
      .def(
          "set",
          [](AxesPart& self, const std::vector<std::pair<int, double>>& places, bool homed,
             bool triggered) {
            Job& job = self.job;
            job.motion.flush();
            auto p = job.position();
            unsigned found = 0;  // slots
            for (auto [axis, mm] : places) {
              p[size_t(slot_of_axis(axis))] = mm;
              if (triggered) found |= 1u << slot_of_axis(axis);
              job.interpreter.set_axis(slot_of_axis(axis), mm, homed);
              job.interpreter.lock(slot_of_axis(axis), false);
            }
            job.motion.set_position(p.data(), job.interpreter.extruder(), found);
          },
          "places"_a, "homed"_a = false, "triggered"_a = false,
          "Sets the positions of these axes, by number, in mm, without motion. With `homed`, they "
          "are homed there. `triggered`: an endstop has found the positions, so the gap of the "
          "drives is "
          "taken up in the direction of the last steps.")
      .def(
          "set_position",
          [](AxesPart& self, const std::vector<std::pair<int, double>>& places) {
            Job& job = self.job;
            job.motion.flush();
            auto p = job.position();
            for (auto [slot, mm] : places) {
              p.at(size_t(slot)) = mm;
              job.interpreter.set_place(slot, mm);
            }
            job.motion.set_position(p.data(), job.interpreter.extruder());
          },
          "places"_a,
          "Sets the position of the machine (slots, machine mm), without motion. The program's "
          "offsets stay.")
      .def(
          "lock",
          [](AxesPart& self, int axis, bool locked) {
            self.job.interpreter.lock(slot_of_axis(axis), locked);
          },
          "axis"_a, "locked"_a,
          "The position of a locked axis is unknown: its moves are errors until the position is "
          "set.")
      .def(
          "use_joints",
          [](AxesPart& self, bool on) {
            self.job.motion.flush();
            self.job.motion.use_joints(on);
          },
          "on"_a,
          "From now on X, Y and Z are the first three actuators of a nonlinear geometry, or the "
          "axes again. Call it only at standstill; `axes.set` must follow.")
      .def(
          "set_geometry",
          [](AxesPart& self, const nb::typed<nb::dict, nb::str, nb::any>& spec) {
            self.job.motion.flush();
            self.job.motion.set_geometry(geometry_of(spec));
          },
          "spec"_a,
          "Changes the parameters of the machine's geometry. Call it only at standstill. No motor "
          "moves; `axes.set` must follow.");

  bind_part<HistoryPart>(m, job, "JobHistory", "history",
                         "Lines and positions at a clock of about the last second.")
      .def(
          "line_at",
          [](HistoryPart& self, double ticks) { return self.job.motion.lines().at(ticks); },
          "ticks"_a,
          "Line of the program's move at a clock, or of the last one before (0: none). The clock "
          "must not be before that of the last call.")
      .def(
          "line_near",
          [](HistoryPart& self, double ticks) { return self.job.motion.lines().near(ticks); },
          "ticks"_a, "As line_at, for any clock from a second before the last call of line_at on.")
      .def(
          "layer_near",
          [](HistoryPart& self, double ticks) { return self.job.motion.lines().layer_near(ticks); },
          "ticks"_a, "The layer of the move that line_near means (0: before the first layer).")
      .def(
          "position_at",
          [](HistoryPart& self, double ticks) -> std::optional<std::vector<double>> {
            auto p = self.job.motion.position_at(ticks);
            if (!p) return std::nullopt;
            return std::vector<double>(p->begin(), p->end());
          },
          "ticks"_a,
          "The planned position at a clock of about the last second, as machine_position; None if "
          "the clock is too long ago.")
      .def(
          "tool_at", [](HistoryPart& self, double ticks) { return self.job.motion.tool_at(ticks); },
          "ticks"_a,
          "The tool of the move at a clock of about the last second, or else of the next one; None "
          "if no move follows.")
      .def(
          "filament_at",
          [](HistoryPart& self, double ticks, size_t extruder) {
            return self.job.motion.filament_at(ticks, extruder);
          },
          "ticks"_a, "extruder"_a,
          "Net filament that an extruder has pushed until a clock of about the last second, mm, "
          "without pressure advance. It grows over the whole job, whatever G92 sets.");

  bind_part<MotorsPart>(m, job, "JobMotors", "motors",
                        "The motors, by their number in the machine.")
      .def(
          "set_steps_per_unit",
          [](MotorsPart& self, size_t stepper, double value) {
            if (stepper >= self.job.motion.machine().steppers.size() || !(value > 0))
              throw nb::value_error("no such stepper, or no such scale");
            self.job.motion.flush();
            self.job.motion.set_steps_per_unit(stepper, value);
          },
          "stepper"_a, "value"_a,
          "Changes the steps per unit of a motor. Call it only at standstill.")
      .def(
          "leave_out",
          [](MotorsPart& self, const std::vector<size_t>& steppers) {
            for (size_t i : steppers)
              if (i >= self.job.motion.machine().steppers.size())
                throw nb::index_error("no such stepper");
            self.job.motion.flush();
            self.job.motion.let_rest(steppers);
          },
          "steppers"_a,
          "These motors, by number, make no steps for later moves; all others do. Call it only at "
          "standstill. After moves without a motor, `axes.set` must follow.")
      .def(
          "renew",
          [](MotorsPart& self, const std::vector<size_t>& steppers) {
            self.job.motion.flush();
            for (size_t i : steppers) {
              if (i >= self.job.motion.machine().steppers.size())
                throw nb::index_error("no such stepper");
              self.job.motion.stream().renew(i);
            }
          },
          "steppers"_a,
          "An endstop has stopped these motors: their clocks are sent again before the next step.")
      .def("statistics", &statistics, "Totals of the steps of each motor by name.");

  bind_part<ToolsPart>(m, job, "JobTools", "tools", "The tools and their offsets.")
      .def(
          "use",
          [](ToolsPart& self, size_t tool) {
            const auto& tools = self.job.motion.machine().tools;
            if (tool >= std::max<size_t>(tools.size(), 1)) throw nb::index_error("no such tool");
            self.job.interpreter.take_tool(tool);
          },
          "tool"_a,
          "Selects this tool with its offset, as if the program had selected it. Nothing moves. "
          "Tool 0 is valid on a machine without tools, too.")
      .def(
          "set_offset",
          [](ToolsPart& self, size_t tool, int axis, double mm) {
            if (tool >= self.job.motion.machine().tools.size() || axis < 0 || axis > 2)
              throw nb::value_error("no such tool or axis");
            self.job.set_tool_offset(tool, axis, mm);
          },
          "tool"_a, "axis"_a, "mm"_a, "M218: the offset of a tool along X, Y or Z.")
      .def_prop_ro(
          "offsets",
          [](ToolsPart& self) {
            std::vector<std::vector<double>> offsets;
            for (const Tool& t : self.job.motion.machine().tools)
              offsets.push_back({t.offset[0], t.offset[1], t.offset[2]});
            return offsets;
          },
          "The offsets of each tool in mm: X, Y, Z.")
      .def_prop_ro(
          "offset_due",
          [](ToolsPart& self) {
            const Interpreter& program = self.job.interpreter;
            return std::vector<double>{program.offset_due(kX), program.offset_due(kY),
                                       program.offset_due(kZ)};
          },
          "The additional distance in mm that the next move of an axis makes in X, Y and Z, "
          "because of a tool change or a changed tool offset.");
}
