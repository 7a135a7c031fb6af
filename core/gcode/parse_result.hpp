// Results of the interpreter other than moves.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace passo {

// What Interpreter::next() has found. After `macro` the caller passes the lines of the macro to
// Interpreter::insert().
enum class ParseResult : uint8_t { move, event, macro, error, need_input, end };

// A command that the caller must carry out before it reads on.
struct Event {
  uint32_t line = 0;
  char letter = 0;  // 'G', 'M', 'T', 'S' (laser power of a move); 0 for an extended command
  int number = 0, minor = 0;
  std::string name;  // extended command, in upper case
  std::string text;  // text after the command, without comment
};

enum class Fault : uint8_t {
  number,
  range,  // the value is below point[0] or above the limit
  word,
  repeated,  // a letter comes twice
  letter,    // `word`: the command, a letter that it does not have, and the letters of the axes
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
  stray,         // `word` contains a character that is not G-code; value: Stray::code
  utf_16,        // the text is not UTF-8
  hole,          // text follows zero bytes; value: line of the zero bytes
  after_end,     // commands follow a Ctrl-Z; value: line of the Ctrl-Z
  missing_word,  // `word`: the command, a blank, and what is missing
  call           // of a sub-program; value: a CallFault
};

struct GcodeError {
  uint32_t line = 0;
  Fault fault = Fault::word;
  std::string word;  // the word that is wrong, or the name of the axis
  double value = 0, limit = 0;
  double point[3] = {0, 0, 0};  // the position that cannot be reached, mm
};

// How the interpreter has read a line: its number, whether it had a checksum, and its commands in
// their order.
struct WatchedLine {
  struct Command {
    std::string code;  // as the dialect writes it; empty for a move with the modal code
                       // one
    std::vector<std::string> words;
    std::string text;  // the text after the code, as in the file; empty for moves
  };
  std::string number;
  bool checked = false;
  std::vector<Command> commands;
};

// APrinter's laser words: energy in W·s for one move, density in W·s/mm from now on. 0: the word
// does not exist.
struct LaserWords {
  char energy = 0, density = 0;
  double full_w = 1,
         most_w = 1;  // power of the laser when fully on, and the maximum that a move may use
  bool any() const { return energy || density; }
  bool has(char letter) const { return any() && (letter == energy || letter == density); }
};

}  // namespace passo
