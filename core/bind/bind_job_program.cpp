// The program of a job: its text, options, modes and objects.
#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>
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
#include "gcode/survey.hpp"

namespace nb = nanobind;
using namespace nb::literals;
using namespace passo;

void bind_job_program(nb::module_& m, JobClass& job) {
  bind_part<ProgramPart>(
      m, job, "JobProgram", "program",
      "The text that a job reads: the program's or a console's lines, and their macros.")
      .def(
          "select", [](ProgramPart& self, bool console) { self.job.interpreter.select(console); },
          "console"_a,
          "Selects the console's lines or the program's. Call it only at a boundary between lines.")
      .def_prop_ro(
          "at_boundary", [](ProgramPart& self) { return self.job.interpreter.at_boundary(); },
          "The job is between two lines.")
      .def(
          "restart",
          [](ProgramPart& self, uint32_t first_line) {
            self.job.restart(first_line);
            self.job.motion.lines().forget();
          },
          "first_line"_a = 1,
          "Drops the unread text of the selected source. Its next line has this number.")
      .def_prop_ro(
          "offset", [](ProgramPart& self) { return self.job.interpreter.offset(); },
          "Number of bytes of the selected source that were read.")
      .def(
          "insert",
          [](ProgramPart& self, const nb::bytes& text, const std::string& code) {
            self.job.interpreter.insert(std::string_view(text.c_str(), text.size()), code);
          },
          "text"_a, "code"_a = "",
          "After MACRO: the lines that the call of the macro `code` becomes. They are read next, "
          "with the line number of the call, and then the rest of its line. While they run, also "
          "in macros that they call, the name of a macro that replaces a built-in command is that "
          "of the command.")
      .def(
          "insert_apart",
          [](ProgramPart& self, const nb::bytes& text) {
            self.job.interpreter.insert_apart(std::string_view(text.c_str(), text.size()));
          },
          "text"_a,
          "In the middle of a command: lines that are read before the rest of its line. At their "
          "end, `advance` returns NEED_INPUT until `leave_apart`.")
      .def(
          "leave_apart", [](ProgramPart& self) { self.job.interpreter.leave_apart(); },
          "Drops what is left of the lines of `insert_apart`.")
      .def_prop_ro(
          "commands", [](ProgramPart& self) { return self.job.interpreter.commands(); },
          "The number of commands read, including unknown ones.")
      .def_prop_ro(
          "layer", [](ProgramPart& self) { return self.job.interpreter.layers.count(); },
          "The layer of the line that was read last; 0: before the first layer.")
      .def_prop_ro(
          "macro_depth", [](const ProgramPart& self) { return self.job.interpreter.macro_depth(); },
          "The nesting depth of the running macros of the selected source.")
      .def_prop_ro(
          "subprogram_depth",
          [](const ProgramPart& self) { return self.job.interpreter.subprogram_depth(); },
          "The nesting depth of the running sub-programs of the selected source.")
      .def(
          "forget_macros", [](ProgramPart& self) { self.job.interpreter.forget_macros(); },
          "Drops the unread lines of a console's macros.")
      .def(
          "watch_line",
          [](ProgramPart& self, uint32_t line) { self.job.interpreter.watch_line(line); }, "line"_a,
          "Records the commands of this line of the program, see `watched_line`. Call it before "
          "the line is "
          "read.")
      .def_prop_ro(
          "watched_line",
          [](const ProgramPart& self) {
            const WatchedLine& watched = self.job.interpreter.watched_line();
            std::vector<std::tuple<std::string, std::vector<std::string>, std::string>> commands;
            for (const auto& c : watched.commands) commands.emplace_back(c.code, c.words, c.text);
            return std::make_tuple(watched.number, watched.checked, commands);
          },
          "(number, whether it had a checksum, [(code, words, text), …]) of the line given to "
          "watch_line. The code is empty for a move with the modal code of the last one. The text "
          "is "
          "what follows the code.")
      .def_prop_ro(
          "ends_in_move", [](ProgramPart& self) { return self.job.interpreter.ends_in_move(); },
          "All text was read, and the last line is a move without an end of line.")
      .def(
          "use_survey",
          [](ProgramPart& self, const Survey& survey) {
            self.job.interpreter.subprograms = survey.subprograms();
            self.job.interpreter.layers.expect(survey.layer_mark());
            self.job.interpreter.objects().learn(survey.objects());
          },
          "survey"_a,
          "Sets the sub-programs, the objects and the comments that mark layers for the next "
          "program.")
      .def_prop_ro(
          "has_calls",
          [](ProgramPart& self) {
            const auto& all = self.job.interpreter.subprograms;
            return all && !all->labels.empty();
          },
          "The program has sub-programs.")
      .def(
          "watch_height",
          [](ProgramPart& self, double low, double high) {
            self.job.interpreter.height_low = low;
            self.job.interpreter.height_high = high;
          },
          "low_mm"_a, "high_mm"_a,
          "Before a move that prints below or above these heights, `advance` stops once at an "
          "event "
          "TUNING_TOWER with the height as its word Z. Infinite without a tower.")
      .def_prop_ro(
          "feature_names", [](ProgramPart& self) { return self.job.interpreter.features(); },
          "The kinds of lines that the comments of the file name.");

  bind_part<OptionsPart>(m, job, "JobOptions", "options",
                         "How a job treats lines that the machine cannot carry out.")
      .def_prop_rw(
          "clamp", [](OptionsPart& self) { return self.job.interpreter.clamp; },
          [](OptionsPart& self, bool clamp) { self.job.interpreter.clamp = clamp; },
          "Targets out of range go to the limit, and moves that the machine cannot reach are left "
          "out. It concerns the lines that are read while it is set.")
      .def_prop_ro(
          "clamped",
          [](const OptionsPart& self) {
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
      .def_prop_rw(
          "ignore_tools", [](OptionsPart& self) { return self.job.interpreter.ignore_tools; },
          [](OptionsPart& self, bool ignore) { self.job.interpreter.ignore_tools = ignore; },
          "Selecting a missing tool is an event, not an error.")
      .def_prop_rw(
          "ignore_calls", [](OptionsPart& self) { return self.job.interpreter.ignore_calls; },
          [](OptionsPart& self, bool ignore) { self.job.interpreter.ignore_calls = ignore; },
          "M98 of a sub-program that is missing is an event, not an error.")
      .def_prop_rw(
          "plain", [](OptionsPart& self) { return self.job.interpreter.plain; },
          [](OptionsPart& self, bool plain) { self.job.interpreter.plain = plain; },
          "While it is set, no macro is called: the replaced built-in commands run.");

  bind_part<ModesPart>(
      m, job, "JobModes", "modes",
      "The modal state of the program: units, positioning, retraction, offsets of coordinates.")
      .def_prop_ro(
          "now",
          [](const ModesPart& self) {
            const auto modal = self.job.interpreter.modal();
            return std::make_tuple(modal.absolute, modal.absolute_e, modal.feed_mm_s);
          },
          "(G90, M82, feedrate in mm/s): the modal state of the selected source. The feedrate is "
          "infinite until one is given.")
      .def_prop_ro(
          "gcode", [](ModesPart& self) { return self.job.interpreter.modes(); },
          "G-code, one command a line, that sets tool, feedrate, plane, absolute or relative "
          "positions, and last the units.")
      .def_prop_ro(
          "retraction",
          [](ModesPart& self) {
            Retraction r = self.job.interpreter.retraction();
            return std::make_tuple(r.mm, r.feed_mm_s, r.hop_mm, r.recover_mm, r.recover_feed_mm_s,
                                   r.swap_mm, r.swap_recover_mm);
          },
          "(mm, mm/s, hop mm, extra mm, mm/s back or 0, mm and extra mm of G10 S1) of M207 and "
          "M208.")
      .def_prop_ro(
          "auto_retract", [](ModesPart& self) { return self.job.interpreter.auto_retract(); },
          "The state of M209: moves of E alone retract like G10.")
      .def(
          "shift_zero",
          [](ModesPart& self, int axis, double mm) {
            if (axis < 0 || axis > 2) throw nb::value_error("X, Y or Z");
            self.job.interpreter.shift_zero(axis, mm);
          },
          "axis"_a, "mm"_a,
          "Moves the program's zero (X, Y, Z) without motion: the next move of the axis carries it "
          "out.")
      .def(
          "keep_offset",
          [](ModesPart& self, int axis, double mm) {
            if (axis < 0 || axis > 2) throw nb::value_error("X, Y or Z");
            self.job.interpreter.keep_offset(axis, mm);
          },
          "axis"_a, "mm"_a,
          "Whenever the axis (X, Y, Z) homes, the program's zero is `mm` further from that of the "
          "axis. Calls add up. Now nothing changes.");

  bind_part<ObjectsPart>(m, job, "JobObjects", "objects",
                         "The objects of the program, which can be cancelled one by one.")
      .def_prop_ro(
          "all",
          [](const ObjectsPart& self) {
            std::vector<std::tuple<std::string, bool, std::string, std::string>> list;
            for (const PrintObject& o : self.job.interpreter.objects().all())
              list.emplace_back(o.name, o.cancelled, o.centre, o.outline);
            return list;
          },
          "(name, cancelled, centre, outline) of each object of the program, by number. Centre and "
          "outline are as in the file, or empty.")
      .def_prop_ro(
          "version",
          [](const ObjectsPart& self) { return self.job.interpreter.objects().version(); },
          "A number that changes with each change of `all`, and with each program.")
      .def(
          "of_line",
          [](const ObjectsPart& self, uint32_t line) {
            return self.job.interpreter.object_of_line(line);
          },
          "line"_a, "The object that a recent line of the main program belongs to; -1: none.")
      .def(
          "find",
          [](const ObjectsPart& self, const std::string& name) {
            return self.job.interpreter.objects().find(name);
          },
          "name"_a, "Numbers of the objects of this name, in upper or lower case.")
      .def(
          "cancel",
          [](ObjectsPart& self, int number, bool cancelled) {
            Objects& objects = self.job.interpreter.objects();
            if (number < 0 || objects.numbered(number) < 0) throw nb::index_error("no such object");
            objects.cancel(number, cancelled);
          },
          "number"_a, "cancelled"_a = true,
          "Skips the moves of the object that are read from now on, or no longer skips them.");
}
