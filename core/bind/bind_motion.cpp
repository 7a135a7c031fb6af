// passo._core: Motion, Move, Message. Plans moves that are given one by one, for tests, tools and
// lessons. Whole files use Job.
#include "bind/bind_motion.hpp"

#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <cstring>
#include <memory>
#include <tuple>

#include "bind/bind_height_map.hpp"
#include "bind/bind_machine.hpp"
#include "bind/bind_pieces.hpp"
#include "motion/motion.hpp"

namespace nb = nanobind;
using namespace nb::literals;
using namespace passo;

namespace {

// Owns a Motion and keeps its settled moves for Python.
struct RecordedMotion {
  Motion motion;
  std::vector<Move> moves;
  RecordedMotion(const Machine& machine, bool with_steps) : motion(machine, with_steps) {
    motion.on_move = [this](const Move& m) { moves.push_back(m); };
  }
};

void add_pieces(RecordedMotion& self, const std::vector<PieceSpec>& pieces,
                const std::optional<std::vector<double>>& end, int extruder) {
  self.motion.add_pieces(pieces_of(self.motion.machine(), pieces, end, extruder));
}

void push(RecordedMotion& self, const std::vector<double>& target, double feed,
          const std::string& kind, int extruder, double duration, double radius, bool inner,
          uint32_t line, double flow) {
  const Machine& machine = self.motion.machine();
  if (target.size() != machine.axes.size() + 1)
    throw nb::value_error("target needs one number an axis, then E");
  if (extruder < 0 || (size_t(extruder) >= machine.extruders.size() && !machine.extruders.empty()))
    throw nb::value_error("no such extruder");
  MoveRequest r{};
  for (size_t i = 0; i < machine.axes.size(); ++i) r.target[slot_of_axis(int(i))] = target[i];
  r.target[kE] = target.back();
  for (double x : r.target)
    if (!(std::fabs(x) < 1e6)) throw nb::value_error("a target is beyond 1e6 mm");
  if (!(feed > 0)) throw nb::value_error("the feed rate must be above 0");
  r.feed_mm_s = feed;
  r.duration_s = duration;
  r.radius_mm = radius;
  r.arc_axis = kZ;
  r.line = r.main_line = line;
  r.flow = flow;
  r.extruder = uint16_t(extruder);
  r.kind = kind == "print"     ? MoveKind::print
           : kind == "extrude" ? MoveKind::extrude
           : kind == "dwell"   ? MoveKind::dwell
                               : MoveKind::travel;
  r.arc_inner = inner;
  self.motion.push(r);
  if (self.motion.planner().too_slow() > 0) throw nb::value_error("the move takes beyond 1e6 s");
}

}  // namespace

void bind_motion(nb::module_& m) {
  bind_move(m);
  nb::class_<RecordedMotion>(m, "Motion",
                             "Plans moves, solves and compresses their steps. Not thread-safe.")
      .def(
          "__init__",
          [](RecordedMotion* self, const nb::dict& spec, bool with_steps) {
            new (self) RecordedMotion(machine_of(spec), with_steps);
          },
          "spec"_a, "with_steps"_a = true)
      .def("push", &push, "target"_a, "feed_mm_s"_a, "kind"_a = "travel", "extruder"_a = 0,
           "duration_s"_a = 0.0, "radius_mm"_a = kInfinity, "inner"_a = false, "line"_a = 0,
           "flow"_a = 1.0,
           "Adds a move to the absolute target: one number for each axis, then E. `flow` is the "
           "factor that has scaled E; 0: E is never scaled. Raises ValueError.")
      .def(
          "set_height_map",
          [](RecordedMotion& self, const std::pair<double, double>& first,
             const std::pair<double, double>& spacing, const Rows& heights, const FadeSpec& fade) {
            self.motion.set_height_map(height_map_of(first, spacing, heights, fade));
          },
          "first"_a, "spacing"_a, "heights"_a, "fade"_a = nb::none(), kHeightMapText)
      .def("add_pieces", &add_pieces, "pieces"_a, "end"_a = nb::none(), "extruder"_a = 0,
           kPiecesText)
      .def(
          "record",
          [](RecordedMotion& self, uint16_t target, uint32_t value) {
            self.motion.record(target, value);
          },
          "target"_a, "value"_a, "A timed record, due when the moves pushed so far are done.")
      .def(
          "set_position",
          [](RecordedMotion& self, const std::vector<double>& position) {
            const Machine& machine = self.motion.machine();
            if (position.size() != machine.axes.size() + 1)
              throw nb::value_error("a position needs one number an axis, then E");
            double p[kAxes] = {};
            for (size_t i = 0; i < machine.axes.size(); ++i) p[slot_of_axis(int(i))] = position[i];
            p[kE] = position.back();
            self.motion.set_position(p, 0);
          },
          "position"_a,
          "Sets the position of the machine, without motion. Call it only while nothing is queued.")
      .def(
          "flush", [](RecordedMotion& self) { self.motion.flush(); },
          "Settles all moves, for a stop at the end.")
      .def(
          "wait_until", [](RecordedMotion& self, double ticks) { self.motion.wait_until(ticks); },
          "ticks"_a)
      .def(
          "replan_from",
          [](RecordedMotion& self, double ticks) { return self.motion.replan_from(ticks); },
          "ticks"_a,
          "Plans again from this clock on with the present limits. Returns the clock of the cut.")
      .def(
          "shift_from",
          [](RecordedMotion& self, double ticks, int axis, double mm) {
            if (axis < 0 || axis > 2) throw nb::value_error("X, Y or Z");
            return self.motion.shift_from(ticks, axis, mm, 0, 0);
          },
          "ticks"_a, "axis"_a, "mm"_a,
          "Shifts all motion from this clock on by `mm` along an axis. Returns the clock of the "
          "cut.")
      .def(
          "change_flow_from",
          [](RecordedMotion& self, double ticks, double flow, size_t extruder) {
            if (extruder >= self.motion.machine().extruders.size())
              throw nb::index_error("no such extruder");
            if (!(flow > 0 && flow < kInfinity)) throw nb::value_error("a flow must be above 0");
            FlowChange change(flow);
            return self.motion.change_flow_from(ticks, extruder, change);
          },
          "ticks"_a, "flow"_a, "extruder"_a = 0,
          "Changes the flow of an extruder after this clock. Returns the clock of the cut.")
      .def(
          "skip_dwell_from",
          [](RecordedMotion& self, double ticks) { return self.motion.skip_dwell_from(ticks); },
          "ticks"_a,
          "Ends the dwell at this clock. Returns the clock of the cut, or None if there is no "
          "dwell.")
      .def(
          "hold_from",
          [](RecordedMotion& self, double ticks) { return self.motion.hold_from(ticks); },
          "ticks"_a,
          "Brakes to a stop on the path from this clock on. Returns the clock of the cut.")
      .def(
          "release", [](RecordedMotion& self) { self.motion.release(); },
          "Continues the moves that hold_from has stopped.")
      .def(
          "use_commits",
          [](RecordedMotion& self, int64_t period, size_t most) {
            self.motion.use_commits(period, most);
          },
          "period"_a, "most"_a,
          "From now on messages come in commits of at most this many ticks and messages. Call it "
          "only after flush().")
      .def(
          "set_speed_factor",
          [](RecordedMotion& self, double factor, bool live) {
            self.motion.planner().rules().change(live, [&](Rules& r) { r.speed_factor = factor; });
          },
          "factor"_a, "live"_a = true,
          "M220: the speed factor of later moves; with `live`, also of moves that are planned "
          "again.")
      .def(
          "set_accel",
          [](RecordedMotion& self, double accel, bool live) {
            self.motion.planner().rules().change(live, [&](Rules& r) {
              r.limits.print_accel = r.limits.travel_accel = r.limits.retract_accel = accel;
            });
          },
          "accel"_a, "live"_a = true)
      .def(
          "set_advance",
          [](RecordedMotion& self, size_t extruder, double seconds) {
            self.motion.planner().advance.at(extruder) = seconds;
          },
          "extruder"_a, "seconds"_a, "Sets the pressure advance of later moves.")
      .def_prop_ro(
          "clock", [](RecordedMotion& self) { return self.motion.planner().clock(); },
          "End of the last settled move, ticks.")
      .def(
          "take_moves", [](RecordedMotion& self) { return std::exchange(self.moves, {}); },
          "Moves settled since the last call, in order.")
      .def(
          "take_messages",
          [](RecordedMotion& self, double before) {
            std::vector<std::tuple<std::string, int, int64_t, int64_t, uint32_t, int, int, int>>
                out;
            MessageQueue& queue = self.motion.stream().messages(0);
            while (!queue.empty() && double(queue.front().clock) < before) {
              const Message& g = queue.front();
              const char* names[] = {"queue_step", "set_dir", "reset_clock",
                                     "pin",        "tail",    "commit"};
              out.emplace_back(names[int(g.kind)], g.target, g.clock, g.end_clock, g.interval,
                               g.count, g.add, g.dir);
              queue.pop();
            }
            return out;
          },
          "before"_a = kInfinity,
          "Takes (kind, target, clock, end_clock, interval, count, add, dir) of all messages due "
          "before a clock.")
      .def(
          "counts",
          [](RecordedMotion& self) {
            std::vector<int64_t> out;
            for (size_t i = 0; i < self.motion.machine().steppers.size(); ++i)
              out.push_back(self.motion.stream().count(i));
            return out;
          },
          "Step count of every motor after all solved moves.")
      .def("dropped_pairs",
           [](RecordedMotion& self, size_t i) {
             return self.motion.stream().statistics(i).dropped_pairs;
           })
      .def(
          "ideal_ticks",
          [](RecordedMotion& self, const Move& move, size_t stepper, int64_t count) {
            const Machine& machine = self.motion.machine();
            StepSolver solver(machine, machine.steppers.at(stepper));
            solver.set_count(count);
            Steps steps;
            solver.solve(move, steps);
            return std::make_tuple(steps.ticks, solver.count());
          },
          "move"_a, "stepper"_a, "count"_a,
          "Unrounded step times of one motor in one move, and its count after it.")
      .def(
          "ideal_piece_ticks",
          [](RecordedMotion& self, double seconds, const Rows& rows, size_t stepper, int64_t count,
             int extruder) {
            const Machine& machine = self.motion.machine();
            StepSolver solver(machine, machine.steppers.at(stepper));
            solver.set_count(count);
            Steps steps;
            solver.solve(piece_of(machine, {seconds, rows}, extruder), steps);
            return std::make_tuple(steps.ticks, solver.count());
          },
          "seconds"_a, "coefficients"_a, "stepper"_a, "count"_a, "extruder"_a = 0,
          "The same for one piece that starts at tick 0.");
}
