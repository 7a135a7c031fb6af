// The results of the interpreter other than moves.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace passo {

// `macro` is an event too: a call whose lines Interpreter::insert takes.
enum class Found : uint8_t { move, event, macro, error, need_input, end };

// A command that the caller must handle before it asks for more.
struct Event {
  uint32_t line = 0;
  char letter = 0;  // 'G', 'M', 'T', 'S' (laser power of a move), or 0: extended command
  int number = 0, minor = 0;
  std::string name;  // of an extended command, upper case
  std::string text;  // text after the command, without comment
};

enum class Fault : uint8_t {
  number,
  range,  // beyond point[0] or the limit
  word,
  repeated,  // a letter
  letter,    // `word`: the command, a letter that it does not have, and those of the axes
  checksum,
  line_too_long,
  feedrate,
  arc,
  centre,
  radii,
  out_of_range,
  missing_tool,
  not_homed,
  cold,
  garbage,
  unsaved,
  unreachable,
  actuator,
  too_long,
  too_slow,
  stray,         // a character in `word` is not G-code; value: as Stray::code
  utf_16,        // the text is not UTF-8
  hole,          // text follows zero bytes; value: their line
  after_end,     // commands follow a Ctrl-Z; value: its line
  missing_word,  // `word`: the command, a blank, what it lacks
  call           // of a sub-program; value: a CallFault
};

struct GcodeError {
  uint32_t line = 0;
  Fault fault = Fault::word;
  std::string word;  // the offending word, or the axis
  double value = 0, limit = 0;
  double point[3] = {0, 0, 0};  // the position that cannot be reached, mm
};

// A line as the interpreter has read it: its number, whether it had a checksum, and its commands in
// order.
struct WatchedLine {
  struct Command {
    std::string code;  // as the dialect writes it; empty: a move with the modal code of the last
                       // one
    std::vector<std::string> words;
    std::string text;  // the text after the code, as it is written; empty for moves
  };
  std::string number;
  bool checked = false;
  std::vector<Command> commands;
};

// APrinter's words of a laser, in W·s for a move and in W·s/mm from now on; 0: no such word.
struct LaserWords {
  char energy = 0, density = 0;
  double full_w = 1, most_w = 1;  // the laser's power fully on, and what a move may ask for
  bool any() const { return energy || density; }
  bool has(char letter) const { return any() && (letter == energy || letter == density); }
};

}  // namespace passo
