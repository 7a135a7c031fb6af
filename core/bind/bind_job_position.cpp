// Where a job's machine is, and moves outside of its program.
#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "bind/bind_job.hpp"

namespace nb = nanobind;
using namespace nb::literals;
using namespace passo;

void bind_job_position(JobClass& job) {
  job.def(
         "settle_position", [](JobView& self) { self.job.settle_position(); },
         "After homing: stop, and be where the program says.")
      .def_prop_ro(
          "stop_position",
          [](JobView& self) {
            if (!self.job.motion.suspended()) throw nb::value_error("nothing is suspended");
            const double* p = self.job.motion.stop_position();
            return std::vector<double>(p, p + kAxes);
          },
          "Where a suspended job goes on: X, Y, Z, E and further axes, in machine mm.")
      .def(
          "use_tool",
          [](JobView& self, size_t tool) {
            const auto& tools = self.job.motion.machine().tools;
            if (tool >= std::max<size_t>(tools.size(), 1)) throw nb::index_error("no such tool");
            self.job.interpreter.take_tool(tool);
          },
          "tool"_a,
          "This tool is in use, with its offset, as if the program had selected it; nothing moves. "
          "Tool 0 may be named without tools, too.")
      .def_prop_ro(
          "machine_position",
          [](JobView& self) {
            const auto p = self.job.position();
            return std::vector<double>(p.begin(), p.end());
          },
          "End of the plan: X, Y, Z, E of the tool in use and further axes, in machine mm.")
      .def(
          "move_to",
          [](JobView& self, const std::vector<double>& target, double feed_mm_s,
             Job::Within within) {
            if (target.size() != kAxes) throw nb::value_error("eight positions");
            return self.job.move_to(target.data(), feed_mm_s, within);
          },
          "target"_a, "feed_mm_s"_a, "within"_a = Job::Within::limits,
          "A straight move in machine coordinates (NaN: stay). False, and nothing is changed, if "
          "it is too long, or not within what it must keep to: see error.")
      .def(
          "set_axes",
          [](JobView& self, const std::vector<std::pair<int, double>>& places, bool homed) {
            Job& job = self.job;
            job.motion.flush();
            auto p = job.position();
            for (auto [axis, mm] : places) {
              p[size_t(slot_of_axis(axis))] = mm;
              job.interpreter.set_axis(slot_of_axis(axis), mm, homed);
              job.interpreter.lock(slot_of_axis(axis), false);
            }
            job.motion.set_position(p.data(), job.interpreter.extruder());
          },
          "places"_a, "homed"_a = false,
          "These axes, by number, are here now (mm), without motion; and at home there, if they "
          "are "
          "`homed`.")
      .def(
          "use_joints",
          [](JobView& self, bool on) {
            self.job.motion.flush();
            self.job.motion.use_joints(on);
          },
          "on"_a,
          "X, Y and Z are from now on the first three actuators of a nonlinear geometry, or the "
          "axes "
          "again; only while the machine stands, and set_axes must say where they are.")
      .def(
          "renew_steppers",
          [](JobView& self, const std::vector<size_t>& steppers) {
            self.job.motion.flush();
            for (size_t i : steppers) {
              if (i >= self.job.motion.machine().steppers.size())
                throw nb::index_error("no such stepper");
              self.job.motion.stream().renew(i);
            }
          },
          "steppers"_a,
          "An endstop has stopped these motors: their clocks are told anew before the next step.")
      .def(
          "lock_axis",
          [](JobView& self, int axis, bool locked) {
            self.job.interpreter.lock(slot_of_axis(axis), locked);
          },
          "axis"_a, "locked"_a,
          "A locked axis does not know where it is: moves of it are errors, until it is set.")
      .def_prop_ro("locked_axes",
                   [](JobView& self) {
                     std::vector<int> axes;
                     for (size_t a = 0; a < self.job.motion.machine().axes.size(); ++a)
                       if (self.job.interpreter.locked(slot_of_axis(int(a))))
                         axes.push_back(int(a));
                     return axes;
                   })
      .def(
          "line_at", [](JobView& self, double ticks) { return self.job.motion.lines().at(ticks); },
          "ticks"_a,
          "Line of the program's move that is under way, or was last, at a clock (0: none). Clocks "
          "must not go back.")
      .def(
          "line_near",
          [](JobView& self, double ticks) { return self.job.motion.lines().near(ticks); },
          "ticks"_a, "As line_at, for any clock from a second before the last one asked for.")
      .def(
          "layer_near",
          [](JobView& self, double ticks) { return self.job.motion.lines().layer_near(ticks); },
          "ticks"_a, "The layer of that move (0: before the first one).")
      .def(
          "position_at",
          [](JobView& self, double ticks) -> std::optional<std::vector<double>> {
            auto p = self.job.motion.position_at(ticks);
            if (!p) return std::nullopt;
            return std::vector<double>(p->begin(), p->end());
          },
          "ticks"_a,
          "Where the plan was at a clock not much more than a second ago, as machine_position; "
          "None "
          "if it is longer ago.");
}
