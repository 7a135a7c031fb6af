// passo._core.Job: whole programs through one machine.
#include "bind/bind_job.hpp"

#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <tuple>

#include "bind/bind_machine.hpp"
#include "gcode/exponents.hpp"
#include "gcode/stray.hpp"
#include "gcode/survey.hpp"

namespace nb = nanobind;
using namespace nb::literals;
using namespace passo;

namespace {

using Table = nb::typed<nb::dict, nb::str, nb::any>;

// M is a word of a move only where it is one of these letters.
LaserWords laser_words(const nb::object& laser) {
  LaserWords words;
  if (laser.is_none()) return words;
  auto letter = [&](const char* key) {
    std::string text = get<std::string>(laser, key);
    return text.empty() ? char(0) : text[0];
  };
  words.energy = letter("energy_letter");
  words.density = letter("density_letter");
  words.full_w = get<double>(laser, "full_w");
  words.most_w = get<double>(laser, "most_w");
  return words;
}

using ErrorTuple =
    std::tuple<uint32_t, Fault, std::string, double, double, std::tuple<double, double, double>>;

std::vector<double> homes(const nb::dict& spec) {
  std::vector<double> home;
  for (nb::handle axis : spec["axes"]) home.push_back(get<double>(axis, "home"));
  return home;
}

using EventTuple = std::tuple<uint32_t, std::string, int, int, std::string, std::string>;

EventTuple as_tuple(const Event& e) {
  return {e.line, e.letter ? std::string(1, e.letter) : std::string(), e.number, e.minor, e.name,
          e.text};
}

ErrorTuple as_tuple(const GcodeError& e) {
  return {e.line, e.fault, e.word, e.value, e.limit, {e.point[0], e.point[1], e.point[2]}};
}

nb::typed<nb::dict, nb::str, nb::float_> cpu(const JobView& self) {
  const Job& job = self.job;
  nb::dict d;
  d["parse"] = job.cpu_parse;
  d["plan"] = job.cpu_plan;
  d["steps"] = job.motion.cpu().steps;
  d["compress"] = job.motion.cpu().compress;
  return nb::typed<nb::dict, nb::str, nb::float_>(d);
}

Table statistics(JobView& self) {
  Job& job = self.job;
  const PlanStatistics& plan = job.motion.plan();
  const Machine& machine = job.motion.machine();
  nb::dict d, limits, features;
  d["lines"] = job.interpreter.line();
  d["moves"] = plan.moves;
  d["arcs"] = job.interpreter.arcs();
  d["move_s"] = plan.move_s;
  d["dwell_s"] = plan.dwell_s;
  d["travel_mm"] = plan.travel_mm;
  d["print_mm"] = plan.print_mm;
  d["filament_mm"] = plan.filament_mm;
  d["layers"] = job.interpreter.layers.count();
  d["layer_s"] = plan.layer_s;
  const auto& names = job.motion.planner().constraints().names;
  for (size_t i = 0; i < plan.limit_s.size(); ++i)
    if (plan.limit_s[i] > 0) limits[names[i].c_str()] = plan.limit_s[i];
  d["limit_s"] = limits;
  nb::dict loads;
  auto exceed = [&](const char* name, const PlanStatistics::Load& load) {
    if (load.share > 1) loads[name] = std::make_tuple(load.line, load.share);
  };
  exceed("steps", plan.most_steps);
  exceed("commands", plan.most_commands);
  d["loads"] = loads;
  nb::dict densest;
  auto put = [&](const char* name, const PlanStatistics::Peak& p) {
    densest[name] = std::make_tuple(p.line, p.most);
  };
  put("steps_s", plan.steps_s);
  put("commands_s", plan.commands_s);
  put("ahead", plan.ahead);
  d["densest"] = densest;
  d["widened_s"] = plan.widened_s;
  d["widest_ticks"] = plan.widest_ticks;
  for (size_t i = 0; i < plan.feature_s.size(); ++i) {
    if (plan.feature_s[i] <= 0) continue;
    const std::string& name = job.interpreter.features()[i];
    features[name.empty() ? "other" : name.c_str()] = plan.feature_s[i];
  }
  d["feature_s"] = features;
  std::vector<double> position;
  for (size_t i = 0; i < machine.axes.size(); ++i)
    position.push_back(job.motion.planner().position()[slot_of_axis(int(i))]);
  for (size_t i = 0; i < machine.extruders.size(); ++i)
    position.push_back(job.motion.planner().extruder_position(i));
  d["position_mm"] = position;
  return Table(d);
}

using LayerTuple = std::tuple<uint32_t, double, double, uint16_t>;
using ToolpathTuple =
    std::tuple<uint32_t, std::vector<double>, double, double, std::vector<LayerTuple>, nb::bytes>;

std::optional<ToolpathTuple> take_toolpath(JobView& self) {
  if (!self.toolpath) return std::nullopt;
  self.job.motion.on_move = nullptr;
  const Toolpath path = *std::exchange(self.toolpath, std::nullopt);
  const Toolpath::Scale scale = path.scale();
  std::vector<LayerTuple> layers;
  for (const Toolpath::Layer& layer : path.layers())
    layers.emplace_back(layer.row, layer.z_mm, layer.start_s, layer.number);
  const std::string data = path.encoded();
  return ToolpathTuple(uint32_t(path.rows()), {scale.origin, scale.origin + 3}, scale.unit_mm,
                       path.end_s(), std::move(layers), nb::bytes(data.data(), data.size()));
}

nb::typed<nb::list, Table> steppers(JobView& self) {
  nb::typed<nb::list, Table> list;
  Motion& motion = self.job.motion;
  for (size_t i = 0; i < motion.machine().steppers.size(); ++i) {
    const StepStatistics& s = motion.stream().statistics(i);
    nb::dict d;
    d["name"] = motion.machine().steppers[i].name;
    d["steps_per_unit"] = motion.machine().steppers[i].steps_per_unit;
    d["steps"] = s.steps;
    d["net"] = s.net;
    d["count"] = motion.stream().count(i);
    d["expected_net"] = motion.stream().expected_net(i);
    d["commands"] = s.commands;
    d["dropped_pairs"] = s.dropped_pairs;
    d["error_max_ticks"] = s.error_max;
    d["error_square_ticks2"] = s.error_square;
    list.append(d);
  }
  return list;
}

void bind_objects(nb::class_<JobView>& job) {
  job.def_prop_ro(
         "objects",
         [](const JobView& self) {
           std::vector<std::tuple<std::string, bool, std::string, std::string>> list;
           for (const PrintObject& o : self.job.interpreter.objects().all())
             list.emplace_back(o.name, o.cancelled, o.centre, o.outline);
           return list;
         },
         "(name, cancelled, centre, outline) of each object of the program, by number; centre and "
         "outline as they are written, or empty.")
      .def_prop_ro(
          "objects_version",
          [](const JobView& self) { return self.job.interpreter.objects().version(); },
          "Another value after each change of `objects`, and for each program.")
      .def(
          "object_of_line",
          [](const JobView& self, uint32_t line) {
            return self.job.interpreter.object_of_line(line);
          },
          "line"_a,
          "The object that a line of the main program belongs to, of those read lately; -1: none.")
      .def(
          "find_objects",
          [](const JobView& self, const std::string& name) {
            return self.job.interpreter.objects().find(name);
          },
          "name"_a, "Numbers of the objects of this name, in any case.")
      .def(
          "cancel_object",
          [](JobView& self, int number, bool cancelled) {
            Objects& objects = self.job.interpreter.objects();
            if (number < 0 || objects.numbered(number) < 0) throw nb::index_error("no such object");
            objects.cancel(number, cancelled);
          },
          "number"_a, "cancelled"_a = true,
          "Moves of the object that are read from now on are left out, or are not left out.");
}

}  // namespace

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
  nb::enum_<Job::Within>(m, "Within", "What a move outside of any program must keep to.")
      .value("LIMITS", Job::Within::limits, "The machine's limits.")
      .value("REACH", Job::Within::reach, "What its actuators reach: it has been there.")
      .value("ANYTHING", Job::Within::anything, "Nothing: it does not know where it is.");
  nb::enum_<Fault>(m, "Fault")
      .value("NUMBER", Fault::number)
      .value("RANGE", Fault::range)
      .value("WORD", Fault::word)
      .value("CHECKSUM", Fault::checksum)
      .value("LINE_TOO_LONG", Fault::line_too_long)
      .value("FEEDRATE", Fault::feedrate)
      .value("ARC", Fault::arc)
      .value("CENTRE", Fault::centre)
      .value("RADII", Fault::radii)
      .value("REPEATED", Fault::repeated)
      .value("OUT_OF_RANGE", Fault::out_of_range)
      .value("MISSING_TOOL", Fault::missing_tool)
      .value("NOT_HOMED", Fault::not_homed)
      .value("COLD", Fault::cold)
      .value("GARBAGE", Fault::garbage)
      .value("UNSAVED", Fault::unsaved)
      .value("UNREACHABLE", Fault::unreachable)
      .value("ACTUATOR", Fault::actuator)
      .value("TOO_LONG", Fault::too_long)
      .value("TOO_SLOW", Fault::too_slow)
      .value("STRAY", Fault::stray)
      .value("UTF_16", Fault::utf_16)
      .value("HOLE", Fault::hole)
      .value("AFTER_END", Fault::after_end)
      .value("MISSING_WORD", Fault::missing_word)
      .value("CALL", Fault::call);
  nb::enum_<ObjectAction>(m, "ObjectAction", "What a command says about the objects of a print.")
      .value("COUNT", ObjectAction::count, "There are so many.")
      .value("DEFINE", ObjectAction::define, "One of this name.")
      .value("BEGIN", ObjectAction::begin, "What follows belongs to this one.")
      .value("NAME", ObjectAction::name, "Of the one that has begun.")
      .value("END", ObjectAction::end, "What follows belongs to none.")
      .value("CANCEL", ObjectAction::cancel, "This one, by number or name.")
      .value("CANCEL_CURRENT", ObjectAction::cancel_current, "The one that is printed.")
      .value("RESTORE", ObjectAction::restore, "This one, by number or name.")
      .value("RESTORE_ALL", ObjectAction::restore_all);
  m.def(
      "object_orders",
      [](const std::string& code, const std::string& text) {
        std::vector<std::tuple<ObjectAction, int, std::string>> orders;
        for (ObjectOrder& order : ObjectText::read(code, text))
          orders.emplace_back(order.action, order.number, std::move(order.name));
        return orders;
      },
      "code"_a, "text"_a,
      "(action, number, name) of M486 or EXCLUDE_OBJECT…, by what follows the code. The number is "
      "-1 where the object is meant by its name. What cannot be read is left out.");
  nb::enum_<CallFault>(m, "CallFault", "Why M98 or M99 cannot be carried out.", nb::is_arithmetic())
      .value("UNREADABLE", CallFault::unreadable)
      .value("MISSING", CallFault::missing)
      .value("NESTED", CallFault::nested)
      .value("UNENDED", CallFault::unended)
      .value("IDLE", CallFault::idle)
      .value("NO_FILE", CallFault::no_file);
  m.def(
      "without_exponents",
      [](std::string text) {
        std::vector<Word> words;
        split_words(text, words);
        std::string plain = Exponents(text, words, true).expand();
        return plain.empty() ? text : plain;
      },
      "text"_a,
      "A line's command with decimal numbers in place of those with exponents, as a job reads it "
      "on a "
      "machine that has an E.");
  m.def(
      "split_text",
      [](const std::string& text) {
        std::vector<std::tuple<std::string, std::optional<double>, std::optional<std::string>>> all;
        for (TextWord& word : split_text(text))
          all.emplace_back(std::move(word.letter), word.number, std::move(word.text));
        return all;
      },
      "text"_a,
      "The words of a command's text, in order: the letter in upper case, or another character "
      "that "
      "begins no word; its number, not a number for `nan`, or None; the number as it is written, "
      "or "
      "what stands in quotes. Comments in parentheses are left out.");
  m.def(
      "find_stray",
      [](std::string text, bool any) {
        const Stray stray = find_stray(text, any);
        return std::pair(stray.token, stray.code);
      },
      "text"_a, "any"_a,
      "The first character of a command's text that is not G-code: what stands around it, and its "
      "code (0: there is none; below 0: a byte that is not UTF-8). Not `any`: only one that "
      "changes "
      "what the text means.");
  nb::class_<JobView> job(m, "Job", "A G-code program through one machine. Not thread-safe.");
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
          "feed",
          [](JobView& self, const nb::bytes& data) {
            self.job.interpreter.feed(data.c_str(), data.size());
          },
          "data"_a)
      .def(
          "finish", [](JobView& self) { self.job.interpreter.finish(); },
          "No more input will come.")
      .def(
          "select", [](JobView& self, bool console) { self.job.interpreter.select(console); },
          "console"_a, "Reads on from the console's lines, or the program's; only at a boundary.")
      .def_prop_ro(
          "at_boundary", [](JobView& self) { return self.job.interpreter.at_boundary(); },
          "No line is under way.")
      .def(
          "restart",
          [](JobView& self, uint32_t first_line) {
            self.job.interpreter.restart(first_line);
            self.job.motion.lines().forget();
          },
          "first_line"_a = 1,
          "Forgets the unread text of the selected source; its lines count from this one again.")
      .def(
          "abandon", [](JobView& self) { self.job.abandon(); },
          "After an error: forgets the rest of the line and goes on from where the plan ends.")
      .def_prop_ro(
          "offset", [](JobView& self) { return self.job.interpreter.offset(); },
          "Bytes of the selected source that were read.")
      .def_prop_ro(
          "queued", [](JobView& self) { return self.job.motion.planner().queued(); },
          "Moves that are not settled.")
      .def_prop_ro(
          "queued_ticks", [](JobView& self) { return self.job.motion.planner().queued_ticks(); },
          "Ticks that these moves take at least.")
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
          "Where the program is, in its own coordinates: the axes, then E.")
      .def(
          "advance",
          [](JobView& self, double horizon, size_t most, bool to_boundary) {
            nb::gil_scoped_release released;
            return self.job.advance(horizon, most, to_boundary);
          },
          "horizon"_a = kInfinity, "most"_a = size_t(1) << 20, "to_boundary"_a = false,
          "Reads on until something wants the caller, or the plan reaches a clock or a number of "
          "messages; or no further than to the end of the line that it is in.")
      .def_prop_ro(
          "event", [](const JobView& self) { return as_tuple(self.job.interpreter.event()); },
          "(line, letter, number, minor, name, text) of the event or the macro that advance "
          "stopped at.")
      .def(
          "insert",
          [](JobView& self, const nb::bytes& text) {
            self.job.interpreter.insert(std::string_view(text.c_str(), text.size()));
          },
          "text"_a,
          "After MACRO: the lines that the call becomes. They are read next, with the line number "
          "of the call, and then the rest of its line.")
      .def_prop_ro(
          "macro_depth", [](const JobView& self) { return self.job.interpreter.macro_depth(); },
          "How many macros of the selected source are under way within each other.")
      .def_prop_ro(
          "modal",
          [](const JobView& self) {
            const auto modal = self.job.interpreter.modal();
            return std::make_tuple(modal.absolute, modal.absolute_e, modal.feed_mm_s);
          },
          "(G90, M82, feedrate in mm/s): the modal state of what is read; the feedrate is infinite "
          "while none was given.")
      .def_prop_rw(
          "plain", [](JobView& self) { return self.job.interpreter.plain; },
          [](JobView& self, bool plain) { self.job.interpreter.plain = plain; },
          "No macro is called: the commands that they replace are carried out.")
      .def(
          "forget_macros", [](JobView& self) { self.job.interpreter.forget_macros(); },
          "What is left of a console's macros is not carried out.")
      .def(
          "listen", [](JobView& self, uint32_t line) { self.job.interpreter.listen(line); },
          "line"_a, "Before this line of the program is read: notes its commands, see heard.")
      .def_prop_ro(
          "heard",
          [](const JobView& self) {
            const Heard& heard = self.job.interpreter.heard();
            std::vector<std::tuple<std::string, std::vector<std::string>, std::string>> commands;
            for (const auto& c : heard.commands) commands.emplace_back(c.code, c.words, c.text);
            return std::make_tuple(heard.number, heard.checked, commands);
          },
          "(number, whether it had a checksum, [(code, words, text), …]) of the line "
          "listened to. The code is empty for a move in the way of the last one, the text is what "
          "follows the code.")
      .def_prop_ro(
          "ends_in_move", [](JobView& self) { return self.job.interpreter.ends_in_move(); },
          "All was read, and the last line is a move without an end of line.")
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
          "What `clamp` has changed: for each axis the first target that was moved to the limit, "
          "as "
          "`error`, and how many were; then the same of the moves that were left out.")
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
          "flush",
          [](JobView& self) {
            nb::gil_scoped_release released;
            self.job.motion.flush();
          },
          "Settles all for a stop.")
      .def(
          "settle_position", [](JobView& self) { self.job.settle_position(); },
          "After homing: stop, and be where the program says.")
      .def(
          "wait_until", [](JobView& self, double ticks) { self.job.motion.wait_until(ticks); },
          "ticks"_a, "The machine stands until then; only after flush.")
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
          "the machine stands.")
      .def(
          "stop_commits",
          [](JobView& self) {
            self.job.motion.flush();
            self.job.motion.stream().stop_commits();
          },
          "Messages come as they are; only while the machine stands.")
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
      .def_prop_ro(
          "stop_position",
          [](JobView& self) {
            if (!self.job.motion.suspended()) throw nb::value_error("nothing is suspended");
            const double* p = self.job.motion.stop_position();
            return std::vector<double>(p, p + kAxes);
          },
          "Where a suspended job goes on: X, Y, Z, E and further axes, in machine mm.")
      .def(
          "resume",
          [](JobView& self) {
            if (!self.job.motion.suspended()) throw nb::value_error("nothing is suspended");
            self.job.resume();
          },
          "Goes on with what was suspended; the machine must be back at stop_position.")
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
      .def("forget_suspended", [](JobView& self) { self.job.forget_suspended(); })
      .def_prop_ro(
          "machine_position",
          [](JobView& self) {
            const auto p = self.job.position();
            return std::vector<double>(p.begin(), p.end());
          },
          "End of the plan: X, Y, Z, E of the tool in use and further axes, in machine mm.")
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
          "adopt", [](JobView& self, JobView& other) { self.job.adopt(other.job); }, "other"_a,
          "Takes the state of a program that another job has read up to where this machine stands.")
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
          "if it is longer ago.")
      .def(
          "passed", [](JobView& self, double ticks) { self.job.motion.pass(ticks); }, "ticks"_a,
          "Time has passed to this clock, or nothing before it will be planned anew.")
      .def_prop_ro("held", [](JobView& self) { return self.job.motion.held(); })
      .def_prop_ro(
          "clock", [](JobView& self) { return self.job.motion.planner().clock(); },
          "End of the settled plan, ticks.")
      .def_prop_ro(
          "rests", [](JobView& self) { return self.job.motion.planner().rests(); },
          "The settled plan ends at rest: what is queued may begin later.")
      .def_prop_ro(
          "handed_out", [](JobView& self) { return self.job.motion.stream().handed_out(); },
          "Clock of the last message, ticks.")
      .def_prop_ro(
          "commands", [](JobView& self) { return self.job.interpreter.commands(); },
          "How many were read, unknown ones too.")
      .def_prop_ro("line", [](JobView& self) { return self.job.interpreter.line(); })
      .def_prop_ro("layer", [](JobView& self) { return self.job.interpreter.layers.count(); })
      .def_prop_ro("tool", [](JobView& self) { return self.job.interpreter.tool(); })
      .def_prop_ro(
          "messages",
          [](JobView& self) -> MessageQueue& { return self.job.motion.stream().messages(0); },
          nb::rv_policy::reference_internal, "The main board's.")
      .def(
          "messages_of",
          [](JobView& self, size_t board) -> MessageQueue& {
            if (board >= self.job.motion.machine().boards) throw nb::index_error("no such board");
            return self.job.motion.stream().messages(board);
          },
          "board"_a, nb::rv_policy::reference_internal)
      .def(
          "keep_moves",
          [](JobView& self, bool on) {
            if (on)
              self.job.motion.on_move = [&self](const Move& move) { self.moves.push_back(move); };
            else
              self.job.motion.on_move = nullptr;
          },
          "on"_a)
      .def("take_moves", [](JobView& self) { return std::exchange(self.moves, {}); })
      .def(
          "keep_toolpath",
          [](JobView& self) {
            self.toolpath.emplace(self.job.motion.machine().clock_hz);
            self.job.motion.on_move = [&self](const Move& move) { self.toolpath->add(move); };
          },
          "From now on keeps the path of all moves, instead of the moves.")
      .def("take_toolpath", &take_toolpath,
           "The path that was kept, as toolpath.py describes it; None of none. It is kept no more.")
      .def(
          "keep_ideal",
          [](JobView& self, bool on) {
            for (size_t i = 0; i < self.job.motion.machine().steppers.size(); ++i)
              self.job.motion.stream().compressor(i).keep_ideal(on);
          },
          "on"_a, "From now on keeps the ideal time of every step, see take_ideal.")
      .def(
          "take_ideal",
          [](JobView& self, size_t stepper) {
            if (stepper >= self.job.motion.machine().steppers.size())
              throw nb::index_error("no such stepper");
            std::vector<double>& ideal = self.job.motion.stream().compressor(stepper).ideal();
            nb::bytes bytes(reinterpret_cast<const char*>(ideal.data()),
                            ideal.size() * sizeof(double));
            ideal.clear();
            return bytes;
          },
          "stepper"_a, "Ideal ticks (float64) of the steps made into commands since the last call.")
      .def_prop_ro("limit_names",
                   [](JobView& self) { return self.job.motion.planner().constraints().names; })
      .def_prop_ro("feature_names", [](JobView& self) { return self.job.interpreter.features(); })
      .def("statistics", &statistics)
      .def("steppers", &steppers)
      .def("cpu", &cpu);
  bind_job_settings(job);
  bind_objects(job);
  nb::class_<Survey>(m, "Survey", "The commands of a program, found before it runs.")
      .def(
          "__init__",
          [](Survey* self, const nb::dict& spec) {
            new (self) Survey(machine_of(spec), homes(spec), laser_words(spec["laser"]));
          },
          "spec"_a)
      .def(
          "feed",
          [](Survey& self, const nb::bytes& data) {
            nb::gil_scoped_release released;
            self.feed(data.c_str(), data.size());
          },
          "data"_a)
      .def("finish", &Survey::finish, "No more input will come.")
      .def_prop_ro(
          "commands",
          [](const Survey& self) {
            std::vector<EventTuple> list;
            for (const Event& e : self.commands()) list.push_back(as_tuple(e));
            return list;
          },
          "(line, letter, number, minor, name, text) of each command that is no move, once for "
          "each code.")
      .def_prop_ro(
          "bad_calls",
          [](const Survey& self) {
            std::vector<std::tuple<uint32_t, std::string, CallFault>> list;
            for (const auto& c : self.bad_calls()) list.emplace_back(c.line, c.text, c.fault);
            return list;
          },
          "(line, text, fault) of each M98 that cannot be carried out, once it is finished.")
      .def_prop_ro("moves", &Survey::moves, "The program moves the machine.");
  job.def(
         "use_survey",
         [](JobView& self, const Survey& survey) {
           self.job.interpreter.subprograms = survey.subprograms();
           self.job.interpreter.layers.expect(survey.layer_mark());
           self.job.interpreter.objects().learn(survey.objects());
         },
         "survey"_a,
         "Of the program that it reads next: its sub-programs, its objects, and the comments that "
         "mark layers.")
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
          "M98 of a sub-program that is missing is an event, not an error.");
}
