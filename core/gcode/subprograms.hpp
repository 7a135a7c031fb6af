// The sub-programs of a file: the text after its main program, and the numbers that M98 calls.
#pragma once
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "gcode/words.hpp"

namespace passo {

class Subprograms {
 public:
  static constexpr size_t kMaxBytes = size_t(16) << 20;

  struct Label {
    uint32_t number;
    bool program;     // O: starts a sub-program; N: a place within one
    size_t at, stop;  // positions in `text`: its line, and the end of the sub-program
    uint32_t line;    // line number in the file
  };
  std::string text;  // lines, each with \n at its end
  std::vector<Label> labels;

  // Labels are added in the order of the file. If two have the same number, the first one is used.
  void add(const Label& label) {
    by_number_.emplace(key(label.number, label.program), labels.size());
    labels.push_back(label);
  }
  // The sub-program of this number, else the place with this line number; null if there is neither.
  const Label* find(uint32_t number) const {
    for (bool program : {true, false})
      if (auto at = by_number_.find(key(number, program)); at != by_number_.end())
        return &labels[at->second];
    return nullptr;
  }

 private:
  std::unordered_map<uint64_t, size_t> by_number_;

  static uint64_t key(uint32_t number, bool program) { return uint64_t(number) << 1 | program; }
};

// The call that an M98 makes.
struct Call {
  const Subprograms::Label* label = nullptr;
  int repeats = 1;
};

enum class CallFault : uint8_t { none, unreadable, missing, nested, unended, idle, no_file };

// Reads `P1002 L3`. P31002 means three calls of 1002, if there is no sub-program 31002. Sets `call`
// and returns CallFault::none, or returns the fault.
inline CallFault read_call(std::string_view text, const Subprograms& all, Call& call) {
  static constexpr int kMaxRepeats = 9999;
  std::vector<Word> words;
  split_words(text, words);
  double number = -1, repeats = -1;
  for (const Word& w : words) {
    if (!w.whole() || w.value < 0 || w.value > 1e8) return CallFault::unreadable;
    if (w.letter == 'P')
      number = w.value;
    else if (w.letter == 'L')
      repeats = w.value;
    else
      return CallFault::unreadable;
  }
  if (number < 0 || repeats > kMaxRepeats) return CallFault::unreadable;
  call.label = all.find(uint32_t(number));
  if (!call.label && repeats < 0 && number > 9999) {
    repeats = std::floor(number / 10'000);
    call.label = all.find(uint32_t(number - repeats * 10'000));
  }
  call.repeats = repeats < 0 ? 1 : int(repeats);
  return !call.label                  ? CallFault::missing
         : call.repeats > kMaxRepeats ? CallFault::unreadable
                                      : CallFault::none;
}

// Reads the number after O or N at the beginning of a line. Returns false without one.
inline bool read_label(const char* p, const char* end, bool& program, uint32_t& number) {
  while (p < end && (*p == ' ' || *p == '\t' || *p == '/')) ++p;
  if (p == end || !std::strchr("OoNn", *p)) return false;
  program = *p != 'N' && *p != 'n';
  const char* q = ++p;
  uint32_t value = 0;
  for (; q < end && uint8_t(*q - '0') < 10 && value < 100'000'000; ++q)
    value = value * 10 + uint32_t(*q - '0');
  number = value;
  return q > p;
}

}  // namespace passo
