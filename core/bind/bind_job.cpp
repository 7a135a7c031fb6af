// passo._core.Job: runs whole programs on one machine.
#include "bind/bind_job.hpp"

#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <vector>

#include "bind/bind_program.hpp"

namespace nb = nanobind;
using namespace nb::literals;
using namespace passo;

// Each function binds some parts of the class.
void bind_job_program(nb::module_& m, JobClass& job);
void bind_job_plan(nb::module_& m, JobClass& job);
void bind_job_axes(nb::module_& m, JobClass& job);
void bind_job_settings(nb::module_& m, JobClass& job);
void bind_job_results(nb::module_& m, JobClass& job);

void bind_job(nb::module_& m) {
  m.attr("LOAD_MM_S") = Interpreter::kLoadMmS;
  m.attr("UNLOAD_MM_S") = Interpreter::kUnloadMmS;
  m.attr("LONGEST_CHANGE_MM") = Interpreter::kMaxChangeMm;
  nb::enum_<Job::Status>(m, "JobStatus")
      .value("NEED_INPUT", Job::Status::need_input)
      .value("EVENT", Job::Status::event)
      .value("MACRO", Job::Status::macro)
      .value("ERROR", Job::Status::error)
      .value("FULL", Job::Status::full)
      .value("END", Job::Status::end);
  nb::enum_<Job::Within>(m, "Within", "The limits of a move outside of any program.")
      .value("LIMITS", Job::Within::limits, "The machine's limits.")
      .value("REACH", Job::Within::reach, "What its actuators reach: it has been there.")
      .value("ANYTHING", Job::Within::anything, "Nothing: it does not know where it is.");
  JobClass job(m, "Job", "Runs a G-code program on one machine. Not thread-safe.");
  job.def(
         "__init__",
         [](JobView* self, const nb::dict& spec, bool with_steps, bool clamp, bool ignore_tools) {
           new (self)
               JobView(machine_of(spec), homes(spec), laser_words(spec["laser"]), with_steps);
           self->job.interpreter.clamp = clamp;
           self->job.interpreter.ignore_tools = ignore_tools;
         },
         "spec"_a, "with_steps"_a = true, "clamp"_a = false, "ignore_tools"_a = false)
      .def(
          "advance",
          [](JobView& self, double horizon, size_t most, bool to_boundary) {
            nb::gil_scoped_release released;
            return self.job.advance(horizon, most, to_boundary);
          },
          "horizon"_a = kInfinity, "most"_a = size_t(1) << 20, "to_boundary"_a = false,
          "Reads and plans until the caller must act, or the plan reaches a clock or a number of "
          "messages; with `to_boundary`, only the rest of the current line.")
      .def(
          "adopt", [](JobView& self, JobView& other) { self.job.adopt(other.job); }, "other"_a,
          "Takes over the state of a program that another job has read up to the position of this "
          "machine.")
      .def_prop_ro(
          "messages",
          [](JobView& self) -> MessageQueue& { return self.job.motion.stream().messages(0); },
          nb::rv_policy::reference_internal, "The messages of the main board.")
      .def(
          "messages_of",
          [](JobView& self, size_t board) -> MessageQueue& {
            if (board >= self.job.motion.machine().boards) throw nb::index_error("no such board");
            return self.job.motion.stream().messages(board);
          },
          "board"_a, nb::rv_policy::reference_internal, "The messages of a board, by number.")
      .def(
          "feed",
          [](JobView& self, const nb::bytes& data) {
            self.job.interpreter.feed(data.c_str(), data.size());
          },
          "data"_a, "Adds text to the selected source, in pieces of any length.")
      .def(
          "finish", [](JobView& self) { self.job.interpreter.finish(); }, "Ends the input.")
      .def_prop_ro(
          "event", [](const JobView& self) { return as_tuple(self.job.interpreter.event()); },
          "(line, letter, number, minor, name, text) of the event or the macro that advance "
          "stopped at.")
      .def_prop_ro(
          "error", [](const JobView& self) { return as_tuple(self.job.error()); },
          "(line, fault, word, value, limit, point) of the error that advance stopped at.")
      .def(
          "abandon", [](JobView& self) { self.job.abandon(); },
          "After an error: drops the rest of the line and continues at the end of the plan.")
      .def_prop_ro(
          "line", [](JobView& self) { return self.job.interpreter.line(); },
          "The number of the line that was read last.")
      .def_prop_ro(
          "tool", [](JobView& self) { return self.job.interpreter.tool(); }, "The tool in use.")
      .def_prop_ro(
          "clock", [](JobView& self) { return self.job.motion.planner().clock(); },
          "End of the settled plan, ticks.")
      .def(
          "flush",
          [](JobView& self) {
            nb::gil_scoped_release released;
            self.job.motion.flush();
          },
          "Settles all moves, for a stop at the end.")
      .def_prop_ro(
          "machine_position",
          [](JobView& self) {
            const auto p = self.job.position();
            return std::vector<double>(p.begin(), p.end());
          },
          "End of the plan: X, Y, Z, E of the tool in use and further axes, in machine mm.")
      .def_prop_ro(
          "program_position",
          [](JobView& self) {
            const Interpreter& i = self.job.interpreter;
            std::vector<double> p;
            for (size_t a = 0; a < self.job.motion.machine().axes.size(); ++a)
              p.push_back(i.logical(slot_of_axis(int(a))));
            p.push_back(i.logical(kE));
            return p;
          },
          "The position of the program in its own coordinates: the axes, then E.")
      .def_prop_ro(
          "locked_axes",
          [](JobView& self) {
            std::vector<int> axes;
            for (size_t a = 0; a < self.job.motion.machine().axes.size(); ++a)
              if (self.job.interpreter.locked(slot_of_axis(int(a)))) axes.push_back(int(a));
            return axes;
          },
          "The axes, by number, whose position is unknown.");
  bind_job_program(m, job);
  bind_job_plan(m, job);
  bind_job_axes(m, job);
  bind_job_settings(m, job);
  bind_job_results(m, job);
}
