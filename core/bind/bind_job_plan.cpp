// The plan of a job: its timeline, stops, commits and outputs.
#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <optional>
#include <tuple>
#include <vector>

#include "bind/bind_job.hpp"
#include "bind/bind_pieces.hpp"

namespace nb = nanobind;
using namespace nb::literals;
using namespace passo;

void bind_job_plan(nb::module_& m, JobClass& job) {
  bind_part<PlanPart>(m, job, "JobPlan", "plan",
                      "The plan: moves from outside of the program, and changes after a clock.")
      .def_prop_ro(
          "queued", [](PlanPart& self) { return self.job.motion.planner().queued(); },
          "Moves that are not settled.")
      .def_prop_ro(
          "queued_ticks", [](PlanPart& self) { return self.job.motion.planner().queued_ticks(); },
          "The minimum duration of these moves in ticks.")
      .def(
          "move_to",
          [](PlanPart& self, const std::vector<double>& target, double feed_mm_s,
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
          [](PlanPart& self, const std::vector<PieceSpec>& pieces,
             const std::optional<std::vector<double>>& end) {
            Motion& motion = self.job.motion;
            motion.add_pieces(
                pieces_of(motion.machine(), pieces, end, int(self.job.interpreter.extruder())));
            self.job.abandon();
          },
          "pieces"_a, "end"_a = nb::none(), kPiecesText)
      .def(
          "wait_until", [](PlanPart& self, double ticks) { self.job.motion.wait_until(ticks); },
          "ticks"_a, "The machine is idle until this clock. Call it only after flush.")
      .def(
          "replan_from",
          [](PlanPart& self, double ticks) { return self.job.motion.replan_from(ticks); },
          "ticks"_a,
          "Plans again from this clock on with the present limits. Returns the clock of the cut.")
      .def(
          "skip_dwell_from",
          [](PlanPart& self, double ticks) { return self.job.motion.skip_dwell_from(ticks); },
          "ticks"_a,
          "Ends the dwell at this clock. Returns the clock of the cut, or None if there is no "
          "dwell.")
      .def(
          "shift_from",
          [](PlanPart& self, double ticks, int axis, double mm) {
            if (axis < 0 || axis > 2) throw nb::value_error("X, Y or Z");
            return self.job.shift_from(ticks, axis, mm);
          },
          "ticks"_a, "axis"_a, "mm"_a,
          "Shifts all motion from this clock on by `mm` along an axis. Returns the clock of the "
          "cut, or None if an end would be out of range, see error.")
      .def(
          "shift",
          [](PlanPart& self, int axis, double mm) {
            if (axis < 0 || axis > 2) throw nb::value_error("X, Y or Z");
            return self.job.shift(axis, mm);
          },
          "axis"_a, "mm"_a,
          "Shifts all motion after the moves read so far. False if an end would be out of range, "
          "see error.")
      .def(
          "absorb_shift",
          [](PlanPart& self, int axis, double mm) {
            if (axis < 0 || axis > 2) throw nb::value_error("X, Y or Z");
            self.job.motion.flush();
            self.job.absorb_shift(axis, mm);
          },
          "axis"_a, "mm"_a,
          "Earlier shifts of `mm` are part of the height map or of the axis' zero from now on. "
          "Call "
          "it at standstill, after a call of `axes.set_position` or `bed.set_height_map`: no "
          "coordinate of the program "
          "changes, "
          "and suspended moves end where they did.")
      .def(
          "passed", [](PlanPart& self, double ticks) { self.job.motion.pass(ticks); }, "ticks"_a,
          "Nothing before this clock will be planned again, for example because it has passed.")
      .def_prop_ro(
          "rests", [](PlanPart& self) { return self.job.motion.planner().rests(); },
          "The settled plan ends at standstill, so queued moves may begin later.")
      .def_prop_ro(
          "handed_out", [](PlanPart& self) { return self.job.motion.stream().handed_out(); },
          "Clock of the last message, ticks.");

  bind_part<StopsPart>(m, job, "JobStops", "stops",
                       "Stops on the path, and the suspension of the rest of the plan.")
      .def(
          "hold_from",
          [](StopsPart& self, double ticks) { return self.job.motion.hold_from(ticks); }, "ticks"_a,
          "Brakes to a stop on the path from this clock on. Returns the clock of the cut.")
      .def_prop_ro(
          "holds", [](StopsPart& self) { return self.job.motion.held() > 0; },
          "Moves wait for `release`.")
      .def_prop_ro(
          "held", [](StopsPart& self) { return self.job.motion.held(); },
          "The number of moves that wait for `release`.")
      .def(
          "release", [](StopsPart& self) { self.job.motion.release(); },
          "Continues the moves that hold_from has stopped.")
      .def(
          "stop_from",
          [](StopsPart& self, double ticks, bool program) {
            return self.job.stop_from(ticks, program);
          },
          "ticks"_a, "program"_a = true,
          "Brakes to a stop from this clock on and drops later moves. Returns the clock of the "
          "cut.")
      .def(
          "suspend",
          [](StopsPart& self, bool hand_over_macro) { self.job.suspend(hand_over_macro); },
          "hand_over_macro"_a = false,
          "Call it after `hold_from`. Until `resume`, other moves are possible. With "
          "`hand_over_macro`, "
          "the rest of the macro that the program has called is read as if a console had called "
          "it.")
      .def_prop_ro(
          "suspended", [](StopsPart& self) { return self.job.motion.suspended(); },
          "A plan is suspended.")
      .def(
          "resume",
          [](StopsPart& self) {
            if (!self.job.motion.suspended()) throw nb::value_error("nothing is suspended");
            self.job.resume();
          },
          "Resumes the suspended plan; the machine must be back at `position`.")
      .def(
          "forget_suspended", [](StopsPart& self) { self.job.forget_suspended(); },
          "Drops the suspended plan.")
      .def_prop_ro(
          "position",
          [](StopsPart& self) {
            if (!self.job.motion.suspended()) throw nb::value_error("nothing is suspended");
            const double* p = self.job.motion.stop_position();
            return std::vector<double>(p, p + kAxes);
          },
          "The position at which a suspended job resumes: X, Y, Z, E and further axes, in machine "
          "mm.");

  bind_part<CommitsPart>(m, job, "JobCommits", "commits",
                         "The commits of boards that stop by themselves when their link is lost.")
      .def(
          "use",
          [](CommitsPart& self, int64_t period, size_t most) {
            self.job.motion.flush();
            self.job.motion.use_commits(period, most);
          },
          "period"_a, "most"_a,
          "From now on messages come in commits of at most this many ticks and messages. Call it "
          "only while the machine is idle.")
      .def(
          "stop",
          [](CommitsPart& self) {
            self.job.motion.flush();
            self.job.motion.stream().stop_commits();
          },
          "From now on messages do not come in commits. Call it only at standstill.")
      .def(
          "recover_from",
          [](CommitsPart& self, uint32_t serial) { return self.job.motion.recover_from(serial); },
          "serial"_a,
          "The boards have stopped by themselves after this commit: the moves after it are held "
          "until `release`. Returns the clock of the commit. If the commit is not known any more, "
          "returns None and changes nothing.")
      .def(
          "between_stops",
          [](CommitsPart& self, uint32_t serial, uint32_t next) {
            return self.job.motion.stream().between_stops(serial, next);
          },
          "serial"_a, "next"_a,
          "For each motor, the net steps from the stop after commit `serial` to the stop after the "
          "following commit `next`. None if the commits are not known, or not consecutive.");

  bind_part<OutputsPart>(m, job, "JobOutputs", "outputs",
                         "Timed events of outputs, of the laser and of the host.")
      .def(
          "record",
          [](OutputsPart& self, uint16_t target, uint32_t value) {
            self.job.motion.record(target, value);
          },
          "target"_a, "value"_a,
          "A timed record for output `target`, due between the moves before and after.")
      .def(
          "record_at",
          [](OutputsPart& self, double ticks, uint16_t target, uint32_t value) {
            self.job.motion.record_at(ticks, target, value);
          },
          "ticks"_a, "target"_a, "value"_a,
          "A record for output `target` at this clock, independent of planned moves. It cannot be "
          "revoked.")
      .def(
          "mark",
          [](OutputsPart& self, uint16_t target, uint32_t value) {
            self.job.motion.record(uint16_t(Motion::kMark + target), value);
          },
          "target"_a, "value"_a, "A timed record for the host itself, see next_mark.")
      .def_prop_ro(
          "next_mark",
          [](const OutputsPart& self) -> std::optional<std::tuple<int64_t, int, uint32_t>> {
            const auto& marks = self.job.motion.marks();
            if (marks.empty()) return std::nullopt;
            const auto& r = marks.front();
            return std::make_tuple(r.clock, r.target - Motion::kMark, r.value);
          },
          "(clock, target, value) of the earliest mark with a known clock, or None. If the plan is "
          "cut before a mark, its clock changes.")
      .def(
          "pop_mark",
          [](OutputsPart& self) {
            auto& marks = self.job.motion.marks();
            if (!marks.empty()) marks.pop_front();
          },
          "Removes the next mark, if there is one. The caller carries it out.")
      .def(
          "set_laser",
          [](OutputsPart& self, uint16_t target, uint32_t full) {
            self.job.motion.set_laser(target, full);
          },
          "target"_a, "full"_a, "This output is a laser, fully on at `full`.")
      .def(
          "follow_speed",
          [](OutputsPart& self, double share) { self.job.motion.follow_speed(share); }, "share"_a,
          "The laser's fraction of full power at the feedrate of later moves. The power decreases "
          "in proportion where they are slower, and is 0 at standstill. 0: only records set the "
          "power.");
}
