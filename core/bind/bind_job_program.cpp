// A job's program: its text, its position, and its requests to the caller.
#include <nanobind/nanobind.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "bind/bind_job.hpp"
#include "bind/bind_program.hpp"
#include "gcode/survey.hpp"

namespace nb = nanobind;
using namespace nb::literals;
using namespace passo;

namespace {

using ErrorTuple =
    std::tuple<uint32_t, Fault, std::string, double, double, std::tuple<double, double, double>>;

ErrorTuple as_tuple(const GcodeError& e) {
  return {e.line, e.fault, e.word, e.value, e.limit, {e.point[0], e.point[1], e.point[2]}};
}

void bind_objects(JobClass& job) {
  job.def_prop_ro(
         "objects",
         [](const JobView& self) {
           std::vector<std::tuple<std::string, bool, std::string, std::string>> list;
           for (const PrintObject& o : self.job.interpreter.objects().all())
             list.emplace_back(o.name, o.cancelled, o.centre, o.outline);
           return list;
         },
         "(name, cancelled, centre, outline) of each object of the program, by number. Centre and "
         "outline are as in the file, or empty.")
      .def_prop_ro(
          "objects_version",
          [](const JobView& self) { return self.job.interpreter.objects().version(); },
          "A number that changes with each change of `objects`, and with each program.")
      .def(
          "watch_height",
          [](JobView& self, double low, double high) {
            self.job.interpreter.height_low = low;
            self.job.interpreter.height_high = high;
          },
          "low_mm"_a, "high_mm"_a,
          "Before a move that prints below or above these heights, `advance` stops once at an "
          "event "
          "TUNING_TOWER with the height as its word Z. Infinite without a tower.")
      .def(
          "object_of_line",
          [](const JobView& self, uint32_t line) {
            return self.job.interpreter.object_of_line(line);
          },
          "line"_a, "The object that a recent line of the main program belongs to; -1: none.")
      .def(
          "find_objects",
          [](const JobView& self, const std::string& name) {
            return self.job.interpreter.objects().find(name);
          },
          "name"_a, "Numbers of the objects of this name, in upper or lower case.")
      .def(
          "cancel_object",
          [](JobView& self, int number, bool cancelled) {
            Objects& objects = self.job.interpreter.objects();
            if (number < 0 || objects.numbered(number) < 0) throw nb::index_error("no such object");
            objects.cancel(number, cancelled);
          },
          "number"_a, "cancelled"_a = true,
          "Skips the moves of the object that are read from now on, or no longer skips them.");
}

}  // namespace

void bind_job_program(JobClass& job) {
  job.def(
         "feed",
         [](JobView& self, const nb::bytes& data) {
           self.job.interpreter.feed(data.c_str(), data.size());
         },
         "data"_a)
      .def(
          "finish", [](JobView& self) { self.job.interpreter.finish(); }, "Ends the input.")
      .def(
          "select", [](JobView& self, bool console) { self.job.interpreter.select(console); },
          "console"_a,
          "Selects the console's lines or the program's. Call it only at a boundary between lines.")
      .def_prop_ro(
          "at_boundary", [](JobView& self) { return self.job.interpreter.at_boundary(); },
          "The job is between two lines.")
      .def(
          "restart",
          [](JobView& self, uint32_t first_line) {
            self.job.restart(first_line);
            self.job.motion.lines().forget();
          },
          "first_line"_a = 1,
          "Drops the unread text of the selected source. Its next line has this number.")
      .def(
          "abandon", [](JobView& self) { self.job.abandon(); },
          "After an error: drops the rest of the line and continues at the end of the plan.")
      .def_prop_ro(
          "offset", [](JobView& self) { return self.job.interpreter.offset(); },
          "Number of bytes of the selected source that were read.")
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
          "event", [](const JobView& self) { return as_tuple(self.job.interpreter.event()); },
          "(line, letter, number, minor, name, text) of the event or the macro that advance "
          "stopped at.")
      .def(
          "insert",
          [](JobView& self, const nb::bytes& text, const std::string& code) {
            self.job.interpreter.insert(std::string_view(text.c_str(), text.size()), code);
          },
          "text"_a, "code"_a = "",
          "After MACRO: the lines that the call of the macro `code` becomes. They are read next, "
          "with the line number of the call, and then the rest of its line. While they run, also "
          "in macros that they call, the name of a macro that replaces a built-in command is that "
          "of the command.")
      .def_prop_ro(
          "macro_depth", [](const JobView& self) { return self.job.interpreter.macro_depth(); },
          "The nesting depth of the running macros of the selected source.")
      .def_prop_ro(
          "subprogram_depth",
          [](const JobView& self) { return self.job.interpreter.subprogram_depth(); },
          "The nesting depth of the running sub-programs of the selected source.")
      .def_prop_ro(
          "modal",
          [](const JobView& self) {
            const auto modal = self.job.interpreter.modal();
            return std::make_tuple(modal.absolute, modal.absolute_e, modal.feed_mm_s);
          },
          "(G90, M82, feedrate in mm/s): the modal state of the selected source. The feedrate is "
          "infinite until one is given.")
      .def_prop_rw(
          "plain", [](JobView& self) { return self.job.interpreter.plain; },
          [](JobView& self, bool plain) { self.job.interpreter.plain = plain; },
          "While it is set, no macro is called: the replaced built-in commands run.")
      .def(
          "forget_macros", [](JobView& self) { self.job.interpreter.forget_macros(); },
          "Drops the unread lines of a console's macros.")
      .def(
          "listen", [](JobView& self, uint32_t line) { self.job.interpreter.listen(line); },
          "line"_a,
          "Records the commands of this line of the program, see heard. Call it before the line is "
          "read.")
      .def_prop_ro(
          "heard",
          [](const JobView& self) {
            const Heard& heard = self.job.interpreter.heard();
            std::vector<std::tuple<std::string, std::vector<std::string>, std::string>> commands;
            for (const auto& c : heard.commands) commands.emplace_back(c.code, c.words, c.text);
            return std::make_tuple(heard.number, heard.checked, commands);
          },
          "(number, whether it had a checksum, [(code, words, text), …]) of the line given to "
          "listen. The code is empty for a move with the modal code of the last one. The text is "
          "what follows the code.")
      .def_prop_ro(
          "ends_in_move", [](JobView& self) { return self.job.interpreter.ends_in_move(); },
          "All text was read, and the last line is a move without an end of line.")
      .def_prop_ro(
          "error", [](const JobView& self) { return as_tuple(self.job.error()); },
          "(line, fault, word, value, limit, point) of the error that advance stopped at.")
      .def_prop_ro(
          "clamped",
          [](const JobView& self) {
            std::vector<std::pair<ErrorTuple, uint64_t>> all;
            const Job& job = self.job;
            for (int j = 0; j < kAxes; ++j)
              if (const auto& c = job.interpreter.clamped(j); c.times > 0)
                all.emplace_back(as_tuple(c.first), c.times);
            if (job.left_out.times > 0)
              all.emplace_back(as_tuple(job.left_out.first), job.left_out.times);
            return all;
          },
          "The effects of `clamp`: for each axis, the first target that was moved to the limit, in "
          "the form of `error`, and the number of such targets; then the same for skipped moves.")
      .def(
          "use_survey",
          [](JobView& self, const Survey& survey) {
            self.job.interpreter.subprograms = survey.subprograms();
            self.job.interpreter.layers.expect(survey.layer_mark());
            self.job.interpreter.objects().learn(survey.objects());
          },
          "survey"_a,
          "Sets the sub-programs, the objects and the comments that mark layers for the next "
          "program.")
      .def_prop_ro(
          "calls",
          [](JobView& self) {
            const auto& all = self.job.interpreter.subprograms;
            return all && !all->labels.empty();
          },
          "The program has sub-programs.")
      .def_prop_rw(
          "ignore_calls", [](JobView& self) { return self.job.interpreter.ignore_calls; },
          [](JobView& self, bool ignore) { self.job.interpreter.ignore_calls = ignore; },
          "M98 of a sub-program that is missing is an event, not an error.")
      .def_prop_rw(
          "clamp", [](JobView& self) { return self.job.interpreter.clamp; },
          [](JobView& self, bool clamp) { self.job.interpreter.clamp = clamp; },
          "Targets out of range go to the limit, and moves that the machine cannot reach are left "
          "out. It concerns the lines that are read while it is set.")
      .def_prop_rw(
          "ignore_tools", [](JobView& self) { return self.job.interpreter.ignore_tools; },
          [](JobView& self, bool ignore) { self.job.interpreter.ignore_tools = ignore; },
          "Selecting a missing tool is an event, not an error.")
      .def_prop_ro(
          "commands", [](JobView& self) { return self.job.interpreter.commands(); },
          "The number of commands read, including unknown ones.")
      .def_prop_ro("line", [](JobView& self) { return self.job.interpreter.line(); })
      .def_prop_ro("layer", [](JobView& self) { return self.job.interpreter.layers.count(); })
      .def_prop_ro("tool", [](JobView& self) { return self.job.interpreter.tool(); })
      .def_prop_ro("feature_names", [](JobView& self) { return self.job.interpreter.features(); });
  bind_objects(job);
}
