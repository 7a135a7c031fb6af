// passo._core.Job: whole programs through one machine.
#include "bind/bind_job.hpp"

#include <nanobind/nanobind.h>

#include "bind/bind_program.hpp"

namespace nb = nanobind;
using namespace nb::literals;
using namespace passo;

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
  nb::class_<JobView> job(m, "Job", "Runs a G-code program on one machine. Not thread-safe.");
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
          "board"_a, nb::rv_policy::reference_internal);
  bind_job_program(job);
  bind_job_motion(job);
  bind_job_settings(job);
  bind_job_results(job);
}
