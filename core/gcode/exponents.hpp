// Replaces numbers with exponents. In G-code the E of `X1E5` is a word, but some programs print
// exponents (`E9.9e-05`). An E that cannot be a word is the exponent of the number before it.
// docs/reference/gcode.md lists the rules.
#pragma once
#include <algorithm>
#include <cctype>
#include <string>
#include <string_view>
#include <vector>

#include "gcode/word_grammar.hpp"
#include "gcode/words.hpp"

namespace passo {

// Whether an E at p starts an exponent: at most three digits and no decimal point follow.
inline bool looks_like_exponent(const char* p, const char* end) {
  if (p == end || (*p != 'E' && *p != 'e')) return false;
  if (++p < end && (*p == '-' || *p == '+')) ++p;
  const char* first = p;
  while (p < end && std::isdigit(uint8_t(*p))) ++p;
  return p > first && p - first <= 3 && (p == end || *p != '.');
}

// The digits of `number` with the decimal point moved by `power` places.
inline std::string without_exponent(std::string_view number, int power) {
  std::string digits;
  std::string out;
  int point = -1;
  for (char c : number) {
    if (std::isdigit(uint8_t(c)))
      digits += c;
    else if (c == '.')
      point = int(digits.size());
    else
      out += c;
  }
  if (point < 0) point = int(digits.size());
  point += power;
  if (point < 0) digits.insert(0, size_t(-point), '0');
  point = std::max(point, 0);
  if (size_t(point) > digits.size()) digits.append(size_t(point) - digits.size(), '0');
  const std::string fraction = digits.substr(size_t(point));
  digits.resize(size_t(point));
  return out + (digits.empty() ? "0" : digits) + (fraction.empty() ? "" : "." + fraction);
}

// Finds exponents among the words of one line.
class Exponents {
 public:
  // `moves_have_e`: moves of this machine have a word E.
  Exponents(std::string_view text, const std::vector<Word>& words, bool moves_have_e)
      : text_(text), words_(words), moves_have_e_(moves_have_e) {}

  // The text with all exponents written out as decimal numbers; empty if it contains no exponent.
  std::string expand() const {
    std::string out;
    size_t done = 0;
    for (size_t first = 0; first < words_.size();) {
      const Word& command = words_[first];
      if (starts(command) && wordless(command)) break;
      size_t last = first + 1;
      while (last < words_.size() && !starts(words_[last])) ++last;
      for (size_t i = first + 1; i < last; ++i) {
        if (!is_exponent(first, last, i)) continue;
        const Word &number = words_[i - 1], &power = words_[i];
        out.append(text_, done, number.begin + 1 - done);
        out += without_exponent(text_.substr(number.begin + 1, number.end - number.begin - 1),
                                int(power.value));
        done = power.end;
        ++i;
      }
      first = last;
    }
    if (done > 0) out.append(text_, done);
    return out;
  }

 private:
  std::string_view text_;
  const std::vector<Word>& words_;
  bool moves_have_e_;

  static bool starts(const Word& w) { return (w.letter == 'G' || w.letter == 'M') && w.number; }

  // Whether word i is the exponent of the word before it. The words [first, last) are those of one
  // command.
  bool is_exponent(size_t first, size_t last, size_t i) const {
    const Word &number = words_[i - 1], &power = words_[i];
    if (!number.number || power.begin != number.end || starts(number) || number.letter == 'T' ||
        !looks_like_exponent(text_.data() + power.begin, text_.data() + text_.size()))
      return false;
    const char sign = text_[power.begin + 1];
    if (sign == '+' || (sign == '-' && text_[power.begin + 2] == '0'))
      return true;  // printf writes at least two digits
    for (size_t k = first; k < last; ++k)
      if (k != i && words_[k].letter == 'E')
        return true;  // the other E is the word: a letter is used once
    if (!has_e(words_[first])) return true;
    if (sign != '-') return false;
    const bool lower = text_[power.begin] == 'e' && std::isupper(uint8_t(text_[number.begin])) != 0;
    const bool spaced = number.begin == 0 || std::isspace(uint8_t(text_[number.begin - 1])) != 0;
    const bool decimal =
        text_.substr(number.begin, number.end - number.begin).find('.') != std::string_view::npos;
    return lower || (spaced && decimal);
  }
  // Whether the command has a word E.
  bool has_e(const Word& w) const {
    const auto [code, minor] = code_of(w);
    const bool moves = !starts(w) || modal_follows(w) || beside_axes(w.letter, code, minor) ||
                       (w.letter == 'G' && code >= 0 && code <= 3);
    return moves ? moves_have_e_ : takes_e(w.letter, code);
  }
};

}  // namespace passo
