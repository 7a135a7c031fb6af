// Python interface of G-code: words and texts, errors, and the survey of a program.
#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "bind/bind_program.hpp"
#include "gcode/exponents.hpp"
#include "gcode/interpreter.hpp"
#include "gcode/stray.hpp"
#include "gcode/survey.hpp"

namespace nb = nanobind;
using namespace nb::literals;
using namespace passo;

void bind_gcode(nb::module_& m) {
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
      .value("LETTER", Fault::letter)
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
      "The command of a line with decimal numbers instead of numbers with exponents, as a job on a "
      "machine with an E axis reads it.");
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
      "that begins no word; its number (NaN for `nan`) or None; the number as it is written, or "
      "the quoted text. Comments in parentheses are left out.");
  m.def(
      "find_stray",
      [](std::string text, bool any) {
        const Stray stray = find_stray(text, any);
        return std::pair(stray.token, stray.code);
      },
      "text"_a, "any"_a,
      "The first character of a command's text that is not G-code: the text around it, and its "
      "code (0 without one; below 0: a byte that is not UTF-8). Without `any`, only a character "
      "that changes the meaning of the text.");
  nb::enum_<ObjectAction>(m, "ObjectAction", "The action of a command on the objects of a print.")
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
      "(action, number, name) of M486 or EXCLUDE_OBJECT…, from the text after the code. The number "
      "is -1 if the command names the object. Parts that cannot be read are left out.");
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
      .def("finish", &Survey::finish, "Ends the input.")
      .def_prop_ro(
          "commands",
          [](const Survey& self) {
            std::vector<EventTuple> list;
            for (const Event& e : self.commands()) list.push_back(as_tuple(e));
            return list;
          },
          "(line, letter, number, minor, name, text) of each command that is not a move, once for "
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
}
