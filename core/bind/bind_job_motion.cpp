// A job's motion: its timeline with cuts, holds and stops, where the machine is, other moves.
#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "bind/bind_job.hpp"

namespace nb = nanobind;
using namespace nb::literals;
using namespace passo;

namespace {

void bind_position(JobClass& job) {
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
          "The position at which a suspended job resumes: X, Y, Z, E and further axes, in machine "
          "mm.")
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
          "stand_at",
          [](JobView& self, const std::vector<std::pair<int, double>>& places) {
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
          "The machine is here now (slots, machine mm), without motion; the program's offsets "
          "stay.")
      .def(
          "use_joints",
          [](JobView& self, bool on) {
            self.job.motion.flush();
            self.job.motion.use_joints(on);
          },
          "on"_a,
          "X, Y and Z are from now on the first three actuators of a nonlinear geometry, or the "
          "axes "
          "again; only at standstill, and set_axes must say where they are.")
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
          "An endstop has stopped these motors: their clocks are sent again before the next step.")
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

}  // namespace

void bind_job_motion(JobClass& job) {
  job.def_prop_ro(
         "queued", [](JobView& self) { return self.job.motion.planner().queued(); },
         "Moves that are not settled.")
      .def_prop_ro(
          "queued_ticks", [](JobView& self) { return self.job.motion.planner().queued_ticks(); },
          "Ticks that these moves take at least.")
      .def(
          "record",
          [](JobView& self, uint16_t target, uint32_t value) {
            self.job.motion.record(target, value);
          },
          "target"_a, "value"_a,
          "A timed record for output `target`, due between the moves before and after.")
      .def(
          "record_at",
          [](JobView& self, double ticks, uint16_t target, uint32_t value) {
            self.job.motion.record_at(ticks, target, value);
          },
          "ticks"_a, "target"_a, "value"_a,
          "A record for output `target` at this clock, whatever moves are planned; it cannot be "
          "revoked.")
      .def(
          "mark",
          [](JobView& self, uint16_t target, uint32_t value) {
            self.job.motion.record(uint16_t(Motion::kMark + target), value);
          },
          "target"_a, "value"_a, "A timed record for the host itself, see next_mark.")
      .def_prop_ro(
          "next_mark",
          [](const JobView& self) -> std::optional<std::tuple<int64_t, int, uint32_t>> {
            const auto& marks = self.job.motion.marks();
            if (marks.empty()) return std::nullopt;
            const auto& r = marks.front();
            return std::make_tuple(r.clock, r.target - Motion::kMark, r.value);
          },
          "(clock, target, value) of the earliest mark whose clock is known by now; None without "
          "one. A mark after a cut of the plan gets another clock.")
      .def(
          "pop_mark",
          [](JobView& self) {
            auto& marks = self.job.motion.marks();
            if (!marks.empty()) marks.pop_front();
          },
          "Removes the next mark, if there is one: the host carries it out.")
      .def(
          "set_laser",
          [](JobView& self, uint16_t target, uint32_t full) {
            self.job.motion.set_laser(target, full);
          },
          "target"_a, "full"_a, "This output is a laser, fully on at `full`.")
      .def(
          "follow_speed", [](JobView& self, double share) { self.job.motion.follow_speed(share); },
          "share"_a,
          "The laser's share of full power, at the feed rate of the moves that follow; it is less "
          "where they are slower, and none while nothing moves. 0: records alone set it.")
      .def(
          "flush",
          [](JobView& self) {
            nb::gil_scoped_release released;
            self.job.motion.flush();
          },
          "Settles all for a stop.")
      .def(
          "wait_until", [](JobView& self, double ticks) { self.job.motion.wait_until(ticks); },
          "ticks"_a, "The machine is idle until then; only after flush.")
      .def(
          "replan_from",
          [](JobView& self, double ticks) { return self.job.motion.replan_from(ticks); }, "ticks"_a)
      .def(
          "skip_dwell_from",
          [](JobView& self, double ticks) { return self.job.motion.skip_dwell_from(ticks); },
          "ticks"_a,
          "Ends the dwell that is under way at this clock; returns the clock of the cut, None if "
          "there is no dwell.")
      .def(
          "hold_from", [](JobView& self, double ticks) { return self.job.motion.hold_from(ticks); },
          "ticks"_a)
      .def(
          "use_commits",
          [](JobView& self, int64_t period, size_t most) {
            self.job.motion.flush();
            self.job.motion.use_commits(period, most);
          },
          "period"_a, "most"_a,
          "Messages come in commits of at most so many ticks and messages from now on; only while "
          "the machine is idle.")
      .def(
          "stop_commits",
          [](JobView& self) {
            self.job.motion.flush();
            self.job.motion.stream().stop_commits();
          },
          "Messages come as they are; only at standstill.")
      .def(
          "recover_from",
          [](JobView& self, uint32_t serial) { return self.job.motion.recover_from(serial); },
          "serial"_a,
          "The boards have stopped behind this commit by themselves: what was to follow is held "
          "until `release`. Returns its clock; None, and nothing is changed, if it is not known.")
      .def(
          "between_stops",
          [](JobView& self, uint32_t serial, uint32_t next) {
            return self.job.motion.stream().between_stops(serial, next);
          },
          "serial"_a, "next"_a,
          "Net steps by which each motor is further where it has stopped behind the commit `next` "
          "than where it would have behind `serial`, the one before; None if they are not known, "
          "or "
          "do not follow each other.")
      .def_prop_ro(
          "holds", [](JobView& self) { return self.job.motion.held() > 0; },
          "Moves wait for `release`.")
      .def("release", [](JobView& self) { self.job.motion.release(); })
      .def(
          "stop_from",
          [](JobView& self, double ticks, bool program) {
            return self.job.stop_from(ticks, program);
          },
          "ticks"_a, "program"_a = true,
          "Brakes to a stop from this clock on and forgets what was to follow; returns the clock "
          "of "
          "the cut.")
      .def(
          "suspend", [](JobView& self, bool hand_over_macro) { self.job.suspend(hand_over_macro); },
          "hand_over_macro"_a = false,
          "After hold_from: other moves may come before what is held. What is left of a macro of "
          "the program is read as a console's if it is handed over.")
      .def_prop_ro("suspended", [](JobView& self) { return self.job.motion.suspended(); })
      .def(
          "resume",
          [](JobView& self) {
            if (!self.job.motion.suspended()) throw nb::value_error("nothing is suspended");
            self.job.resume();
          },
          "Resumes the suspended plan; the machine must be back at stop_position.")
      .def("forget_suspended", [](JobView& self) { self.job.forget_suspended(); })
      .def(
          "shift_from",
          [](JobView& self, double ticks, int axis, double mm) {
            if (axis < 0 || axis > 2) throw nb::value_error("X, Y or Z");
            return self.job.shift_from(ticks, axis, mm);
          },
          "ticks"_a, "axis"_a, "mm"_a,
          "From this clock on all lies so much further; returns the clock of the cut, None if that "
          "is out of range, see error.")
      .def(
          "shift",
          [](JobView& self, int axis, double mm) {
            if (axis < 0 || axis > 2) throw nb::value_error("X, Y or Z");
            return self.job.shift(axis, mm);
          },
          "axis"_a, "mm"_a,
          "The same behind all moves so far; False if that is out of range, see error.")
      .def(
          "passed", [](JobView& self, double ticks) { self.job.motion.pass(ticks); }, "ticks"_a,
          "Time has passed to this clock, or nothing before it will be replanned.")
      .def_prop_ro("held", [](JobView& self) { return self.job.motion.held(); })
      .def_prop_ro(
          "clock", [](JobView& self) { return self.job.motion.planner().clock(); },
          "End of the settled plan, ticks.")
      .def_prop_ro(
          "rests", [](JobView& self) { return self.job.motion.planner().rests(); },
          "The settled plan ends at rest: what is queued may begin later.")
      .def_prop_ro(
          "handed_out", [](JobView& self) { return self.job.motion.stream().handed_out(); },
          "Clock of the last message, ticks.");
  bind_position(job);
}
