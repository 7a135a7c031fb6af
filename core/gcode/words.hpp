// A line's words: letter and number, with the place in the text.
#pragma once
#include <algorithm>
#include <cctype>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include "gcode/lexer.hpp"

namespace passo {

struct Word {
  char letter;  // upper case
  double value;
  bool number;            // false: a letter alone, or followed by something that is no number
  size_t begin, end;      // in the text
  bool built_in = false;  // a command that no macro replaces here
  bool whole() const { return number && value == std::floor(value); }
};

// What follows a command: its words, and the same as text.
struct Arguments {
  const Word *first, *last;
  std::string_view text;

  bool empty() const { return first == last; }
  bool has(char letter) const {
    return std::any_of(first, last, [&](const Word& x) { return x.letter == letter; });
  }
  double value(char letter, double otherwise) const {
    for (const Word* x = first; x < last; ++x)
      if (x->letter == letter && x->number) return x->value;
    return otherwise;
  }
};

// A command as the dialect table writes it: G1, G59.1.
inline std::string code_name(char letter, int number, int minor = 0) {
  std::string name(1, letter);
  name += std::to_string(number);
  if (minor != 0) (name += '.') += std::to_string(minor);
  return name;
}

// An unknown command as it is written: `text` is the line, which begins with it.
inline std::string unknown_name(std::string_view text, const Word& word) {
  size_t stop =
      word.number ? word.end : std::min(text.find_first_of(" \t", word.begin), text.size());
  std::string name(1, word.letter);
  for (size_t i = word.begin + 1; i < stop; ++i)
    if (!std::isspace(uint8_t(text[i]))) name += text[i];
  return name;
}

// Old files are not always UTF-8: then bytes beyond ASCII become '?', for what leaves the core.
inline std::string readable(std::string_view text) {
  std::string out(text);
  size_t left = 0;  // bytes that the current character still needs
  uint32_t code = 0, least = 0;
  bool good = true;
  for (char c : text) {
    uint8_t byte = uint8_t(c);
    if (left > 0) {
      good = good && (byte & 0xc0) == 0x80;
      code = code << 6 | (byte & 0x3f);
      if (--left == 0) good = good && code >= least && code < 0x110000 && code >> 11 != 0x1b;
    } else if (byte >= 0x80) {
      left = byte >= 0xf0 ? 3 : byte >= 0xe0 ? 2 : 1;
      least = left == 3 ? 0x10000 : left == 2 ? 0x800 : 0x80;
      code = byte & (0x3fu >> left);
      good = good && byte >= 0xc0 && byte < 0xf8;
    }
  }
  if (!good || left > 0)
    for (char& c : out) c = uint8_t(c) < 0x80 ? c : '?';
  return out;
}

// Where the last '*' outside of comments is: npos if there is none.
inline size_t last_star(std::string_view text) {
  size_t depth = 0, star = std::string_view::npos;
  for (size_t i = 0; i < text.size() && (text[i] != ';' || depth > 0); ++i) {
    if (text[i] == '(') ++depth;
    if (text[i] == ')' && depth > 0) --depth;
    if (text[i] == '*' && depth == 0) star = i;
  }
  return star;
}

// Whether nothing but a comment follows.
inline bool nothing_left(const char* p) {
  while (*p == ' ' || *p == '\t') ++p;
  return *p == 0 || *p == ';' || *p == '(';
}

// Comments in parentheses become blanks, what follows ';' goes. `comment` is the text behind ';'.
inline void strip_comments(std::string& text, std::string& comment) {
  comment.clear();
  size_t depth = 0;
  for (size_t i = 0; i < text.size(); ++i) {
    if (text[i] == ';' && depth == 0) {
      comment = text.substr(i + 1);
      text.resize(i);
      break;
    }
    if (text[i] == '(') ++depth;
    bool hide = depth > 0;
    if (text[i] == ')' && depth > 0) --depth;
    if (hide) text[i] = ' ';
  }
  while (!text.empty() && std::isspace(uint8_t(text.back()))) text.pop_back();
}

// Splits into words. A word is a letter and a decimal number, blanks between them allowed.
inline void split_words(std::string_view text, std::vector<Word>& words) {
  words.clear();
  const char *begin = text.data(), *p = begin, *end = begin + text.size();
  while (p < end) {
    if (std::isspace(uint8_t(*p))) {
      ++p;
      continue;
    }
    Word word{};
    word.begin = size_t(p - begin);
    word.letter = char(std::toupper(uint8_t(*p)));
    ++p;
    const char* q = p;
    while (q < end && (*q == ' ' || *q == '\t')) ++q;
    word.number = read_number(q, end, word.value);
    if (word.number) p = q;
    word.end = size_t(p - begin);
    words.push_back(word);
  }
}

}  // namespace passo
