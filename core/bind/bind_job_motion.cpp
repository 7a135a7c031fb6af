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
#include "bind/bind_pieces.hpp"

namespace nb = nanobind;
using namespace nb::literals;
using namespace passo;

namespace {

void bind_position(JobClass& job) {
  job.def(
         "settle_position", [](JobView& self) { self.job.settle_position(); },
         "After homing: ends the plan, and sets the position of the machine to that of the "
         "program.")
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
          "Selects this tool with its offset, as if the program had selected it. Nothing moves. "
          "Tool 0 is valid on a machine without tools, too.")
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
          "A straight move in machine coordinates (NaN: the axis does not move). If the move takes "
          "too long, or is not within the limits of `within`, returns False and changes nothing, "
          "see error.")
      .def(
          "add_pieces",
          [](JobView& self, const std::vector<PieceSpec>& pieces,
             const std::optional<std::vector<double>>& end) {
            Motion& motion = self.job.motion;
            motion.add_pieces(
                pieces_of(motion.machine(), pieces, end, int(self.job.interpreter.extruder())));
            self.job.abandon();
          },
          "pieces"_a, "end"_a = nb::none(), kPiecesText)
      .def(
          "set_axes",
          [](JobView& self, const std::vector<std::pair<int, double>>& places, bool homed,
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
          "Sets the position of the machine (slots, machine mm), without motion. The program's "
          "offsets stay.")
      .def(
          "use_joints",
          [](JobView& self, bool on) {
            self.job.motion.flush();
            self.job.motion.use_joints(on);
          },
          "on"_a,
          "From now on X, Y and Z are the first three actuators of a nonlinear geometry, or the "
          "axes again. Call it only at standstill; set_axes must follow.")
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
          "The position of a locked axis is unknown: its moves are errors until the position is "
          "set.")
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
          "Line of the program's move at a clock, or of the last one before (0: none). The clock "
          "must not be before that of the last call.")
      .def(
          "line_near",
          [](JobView& self, double ticks) { return self.job.motion.lines().near(ticks); },
          "ticks"_a, "As line_at, for any clock from a second before the last call of line_at on.")
      .def(
          "layer_near",
          [](JobView& self, double ticks) { return self.job.motion.lines().layer_near(ticks); },
          "ticks"_a, "The layer of the move that line_near means (0: before the first layer).")
      .def(
          "position_at",
          [](JobView& self, double ticks) -> std::optional<std::vector<double>> {
            auto p = self.job.motion.position_at(ticks);
            if (!p) return std::nullopt;
            return std::vector<double>(p->begin(), p->end());
          },
          "ticks"_a,
          "The planned position at a clock of about the last second, as machine_position; None if "
          "the clock is too long ago.")
      .def(
          "tool_at", [](JobView& self, double ticks) { return self.job.motion.tool_at(ticks); },
          "ticks"_a,
          "The tool of the move at a clock of about the last second, or else of the next one; None "
          "if no move follows.")
      .def(
          "filament_at",
          [](JobView& self, double ticks, size_t extruder) {
            return self.job.motion.filament_at(ticks, extruder);
          },
          "ticks"_a, "extruder"_a,
          "Net filament that an extruder has pushed until a clock of about the last second, mm, "
          "without pressure advance. It grows over the whole job, whatever G92 sets.");
}

}  // namespace

void bind_job_motion(JobClass& job) {
  job.def_prop_ro(
         "queued", [](JobView& self) { return self.job.motion.planner().queued(); },
         "Moves that are not settled.")
      .def_prop_ro(
          "queued_ticks", [](JobView& self) { return self.job.motion.planner().queued_ticks(); },
          "The minimum duration of these moves in ticks.")
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
          "A record for output `target` at this clock, independent of planned moves. It cannot be "
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
          "(clock, target, value) of the earliest mark with a known clock, or None. If the plan is "
          "cut before a mark, its clock changes.")
      .def(
          "pop_mark",
          [](JobView& self) {
            auto& marks = self.job.motion.marks();
            if (!marks.empty()) marks.pop_front();
          },
          "Removes the next mark, if there is one. The caller carries it out.")
      .def(
          "set_laser",
          [](JobView& self, uint16_t target, uint32_t full) {
            self.job.motion.set_laser(target, full);
          },
          "target"_a, "full"_a, "This output is a laser, fully on at `full`.")
      .def(
          "follow_speed", [](JobView& self, double share) { self.job.motion.follow_speed(share); },
          "share"_a,
          "The laser's fraction of full power at the feedrate of later moves. The power decreases "
          "in proportion where they are slower, and is 0 at standstill. 0: only records set the "
          "power.")
      .def(
          "flush",
          [](JobView& self) {
            nb::gil_scoped_release released;
            self.job.motion.flush();
          },
          "Settles all moves, for a stop at the end.")
      .def(
          "wait_until", [](JobView& self, double ticks) { self.job.motion.wait_until(ticks); },
          "ticks"_a, "The machine is idle until this clock. Call it only after flush.")
      .def(
          "replan_from",
          [](JobView& self, double ticks) { return self.job.motion.replan_from(ticks); }, "ticks"_a)
      .def(
          "skip_dwell_from",
          [](JobView& self, double ticks) { return self.job.motion.skip_dwell_from(ticks); },
          "ticks"_a,
          "Ends the dwell at this clock. Returns the clock of the cut, or None if there is no "
          "dwell.")
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
          "From now on messages come in commits of at most this many ticks and messages. Call it "
          "only while the machine is idle.")
      .def(
          "stop_commits",
          [](JobView& self) {
            self.job.motion.flush();
            self.job.motion.stream().stop_commits();
          },
          "From now on messages do not come in commits. Call it only at standstill.")
      .def(
          "recover_from",
          [](JobView& self, uint32_t serial) { return self.job.motion.recover_from(serial); },
          "serial"_a,
          "The boards have stopped by themselves after this commit: the moves after it are held "
          "until `release`. Returns the clock of the commit. If the commit is not known any more, "
          "returns None and changes nothing.")
      .def(
          "between_stops",
          [](JobView& self, uint32_t serial, uint32_t next) {
            return self.job.motion.stream().between_stops(serial, next);
          },
          "serial"_a, "next"_a,
          "For each motor, the net steps from the stop after commit `serial` to the stop after the "
          "following commit `next`. None if the commits are not known, or not consecutive.")
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
          "Brakes to a stop from this clock on and drops later moves. Returns the clock of the "
          "cut.")
      .def(
          "suspend", [](JobView& self, bool hand_over_macro) { self.job.suspend(hand_over_macro); },
          "hand_over_macro"_a = false,
          "Call it after hold_from. Until resume, other moves are possible. With "
          "`hand_over_macro`, "
          "the rest of the macro that the program has called is read as if a console had called "
          "it.")
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
          "Shifts all motion from this clock on by `mm` along an axis. Returns the clock of the "
          "cut, or None if an end would be out of range, see error.")
      .def(
          "shift",
          [](JobView& self, int axis, double mm) {
            if (axis < 0 || axis > 2) throw nb::value_error("X, Y or Z");
            return self.job.shift(axis, mm);
          },
          "axis"_a, "mm"_a,
          "Shifts all motion after the moves read so far. False if an end would be out of range, "
          "see error.")
      .def(
          "shift_zero",
          [](JobView& self, int axis, double mm) {
            if (axis < 0 || axis > 2) throw nb::value_error("X, Y or Z");
            self.job.interpreter.shift_zero(axis, mm);
          },
          "axis"_a, "mm"_a,
          "Moves the program's zero (X, Y, Z) without motion: the next move of the axis carries it "
          "out.")
      .def(
          "keep_offset",
          [](JobView& self, int axis, double mm) {
            if (axis < 0 || axis > 2) throw nb::value_error("X, Y or Z");
            self.job.interpreter.keep_offset(axis, mm);
          },
          "axis"_a, "mm"_a,
          "Whenever the axis (X, Y, Z) homes, the program's zero is `mm` further from that of the "
          "axis. Calls add up. Now nothing changes.")
      .def(
          "absorb_shift",
          [](JobView& self, int axis, double mm) {
            if (axis < 0 || axis > 2) throw nb::value_error("X, Y or Z");
            self.job.motion.flush();
            self.job.absorb_shift(axis, mm);
          },
          "axis"_a, "mm"_a,
          "Earlier shifts of `mm` are part of the height map or of the axis' zero from now on. "
          "Call "
          "it at standstill, after stand_at or set_height_map: no coordinate of the program "
          "changes, "
          "and suspended moves end where they did.")
      .def(
          "passed", [](JobView& self, double ticks) { self.job.motion.pass(ticks); }, "ticks"_a,
          "Nothing before this clock will be planned again, for example because it has passed.")
      .def_prop_ro("held", [](JobView& self) { return self.job.motion.held(); })
      .def_prop_ro(
          "clock", [](JobView& self) { return self.job.motion.planner().clock(); },
          "End of the settled plan, ticks.")
      .def_prop_ro(
          "rests", [](JobView& self) { return self.job.motion.planner().rests(); },
          "The settled plan ends at standstill, so queued moves may begin later.")
      .def_prop_ro(
          "handed_out", [](JobView& self) { return self.job.motion.stream().handed_out(); },
          "Clock of the last message, ticks.");
  bind_position(job);
}
