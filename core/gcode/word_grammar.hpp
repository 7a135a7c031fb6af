// Which words belong to which command. docs/reference/gcode.md describes the rules.
#pragma once
#include <cmath>
#include <cstring>
#include <utility>

#include "gcode/words.hpp"

namespace passo {

inline bool text_command(const Word& w) {  // whether the argument is free text instead of words
  if (w.letter != 'M' || std::fabs(w.value) > 1000) return false;
  int n = int(w.value);
  if (!w.whole()) return n == 862;
  return n == 0 || n == 1 || n == 16 || n == 20 || n == 23 || n == 28 || n == 30 || n == 32 ||
         n == 36 || n == 38 || n == 98 || n == 115 || n == 117 || n == 118 || n == 486 ||
         n == 550 || n == 587 || n == 600 || n == 862 || n == 928;
}

// Whether a line that begins with this text has a command with a free text.
inline bool takes_text(const char* line) {
  std::vector<Word> words;
  split_words(line, words);
  if (words.empty()) return false;
  const char* second = line + words[0].begin + 1;
  const bool name = std::isalpha(uint8_t(second[-1])) != 0 &&
                    (std::isalpha(uint8_t(*second)) != 0 || *second == '_');
  return name || (words[0].number && text_command(words[0]));
}

// Number and decimal of a command: {59, 1} for G59.1.
inline std::pair<int, int> code_of(const Word& w) {
  if (!w.number || std::fabs(w.value) > kLargestWord) return {-1, 0};
  int code = int(w.value);
  return {code, int(std::lround((w.value - code) * 10))};
}

// Commands whose text is not read as words. passo.gcode.registry has the same list.
inline bool wordless(const Word& w) {
  if (text_command(w)) return true;
  const auto [n, minor] = code_of(w);
  if (w.letter == 'G') return minor == 0 && (n == 12 || n == 27 || n == 29);
  return n == 29 || n == 33 || n == 34 || (n >= 75 && n <= 77) || n == 99 || n == 110 || n == 111 ||
         n == 125 || (n >= 163 && n <= 166) || n == 192 || n == 202 || n == 222 || n == 240 ||
         n == 250 || n == 281 || n == 351 || n == 374 || n == 375 || n == 428 || n == 512 ||
         n == 531 || n == 557 || n == 558 || n == 595 || n == 604 || n == 605 || n == 800 ||
         n == 908 || n == 925 || n == 926;
}

// Commands other than moves that have a parameter E. passo.gcode.registry has the same list.
inline bool takes_e(char letter, int code) {
  if (letter == 'G') return code == 61 || code == 92;
  return code == 17 || code == 18 || code == 84 || code == 92 || code == 201 || code == 203 ||
         code == 205 || code == 303 || code == 306 || code == 569 || code == 600 || code == 906 ||
         code == 912 || code == 913 || code == 917;
}

// Commands whose words only the core reads. run_motion() checks the words of moves itself.
inline bool own_command(char letter, int code, int minor) {
  if (minor != 0) return false;
  if (letter == 'G')
    return code == 4 || code == 10 || code == 11 || code == 60 || code == 61 || code == 92;
  return code == 82 || code == 83 || code == 200 || (code >= 207 && code <= 209) || code == 603 ||
         code == 701 || code == 702;
}

// Commands whose further words are a modal move.
inline bool before_modal(char letter, int code, int minor) {
  return letter == 'G' && minor == 0 &&
         ((code >= 17 && code <= 21) || code == 53 || code == 90 || code == 91 || code == 98 ||
          code == 99);
}

// Commands whose axis words are a modal move, because they have no axes in any dialect (RS274):
// polar coordinates, tool radii and lengths, coordinate systems, path modes, rotation, modes of F
// and of spindles. G80 is not among them: on printers it has axes.
inline bool before_axes(char letter, int code, int minor) {
  if (letter != 'G') return false;
  if (minor != 0) return (code == 59 && minor <= 3) || (minor == 1 && (code == 61 || code == 91));
  return code == 15 || code == 40 || code == 43 || code == 49 || (code >= 54 && code <= 59) ||
         code == 64 || code == 69 || (code >= 93 && code <= 97);
}

// Spindle, coolant and tool change: they have words of their own, but no axes. Axis words in their
// line are a move.
inline bool beside_axes(char letter, int code, int minor) {
  return letter == 'M' && minor == 0 && code >= 3 && code <= 9;
}

// Commands whose axis words are a modal move. A T may be the duration of the move.
inline bool modal_follows(const Word& w) {
  const auto [code, minor] = code_of(w);
  return before_modal(w.letter, code, minor) || before_axes(w.letter, code, minor);
}

// A T after these commands starts a new command, not a parameter: G90 T1, M6 T1, M83 T1.
inline bool toolless(const Word& w) {
  const auto [code, minor] = code_of(w);
  return modal_follows(w) || beside_axes(w.letter, code, minor) ||
         (w.letter == 'M' && minor == 0 && (code == 82 || code == 83));
}

// Whether the modal motion is a cycle that Passo carries out. `motion` is ten times the code.
inline bool canned(int motion) {
  return motion == 730 || motion == 810 || motion == 820 || motion == 830;
}

// Motion modes of RS274 that Passo does not have: splines, threads, probing, other cycles. Words
// without a command belong to these modes.
inline bool moves_otherwise(char letter, int code) {
  return letter == 'G' && (code == 5 || code == 33 || code == 38 || code == 73 || code == 76 ||
                           (code >= 81 && code <= 89));
}

// Letters that programs write with 0 for an axis that the machine lacks. The row "G1 A0" of
// passo.gcode.ignored_commands lists these programs.
inline bool idle_letter(char letter, int code) {
  return (letter >= 'A' && letter <= 'C') || (letter == 'E' && code == 92);
}

// Words that need no number in their command. passo.gcode.registry has the same list.
inline bool may_stand_alone(char letter, int code, char word) {
  if (letter == 'G') return code == 61 && std::strchr("ABCDEHIJKUVWXYZ", word);
  return code == 702 && word == 'C';
}

}  // namespace passo
