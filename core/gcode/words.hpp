// The words of a line, each with letter, number and position in the text.
#pragma once
#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "gcode/lexer.hpp"
#include "gcode/utf8.hpp"

namespace passo {

struct Word {
  char letter;  // upper case
  double value;
  bool number;            // false: no number follows the letter
  size_t begin, end;      // positions in the text
  bool built_in = false;  // this command is the built-in one, not a macro
  bool whole() const { return number && value == std::floor(value); }
};

// The parameters of a command, as words and as text.
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

// The name of a command in the tables: G1, G59.1.
inline std::string code_name(char letter, int number, int minor = 0) {
  std::string name(1, letter);
  name += std::to_string(number);
  if (minor != 0) (name += '.') += std::to_string(minor);
  return name;
}

// The name of an unknown command, as it is written in the line `text`.
inline std::string unknown_name(std::string_view text, const Word& word) {
  size_t stop =
      word.number ? word.end : std::min(text.find_first_of(" \t", word.begin), text.size());
  std::string name(1, word.letter);
  for (size_t i = word.begin + 1; i < stop; ++i)
    if (!std::isspace(uint8_t(text[i]))) name += text[i];
  return name;
}

// Whether a line begins with M117 or M118. Their text ends with the line: as in Klipper, neither
// ';' nor a parenthesis starts a comment in it.
inline bool begins_message(std::string_view text) {
  size_t i = 0;
  while (i < text.size() && (text[i] == ' ' || text[i] == '\t')) ++i;
  if (i + 3 >= text.size() || (text[i] != 'M' && text[i] != 'm')) return false;
  const std::string_view code = text.substr(i + 1, 3);
  return (code == "117" || code == "118") &&
         (i + 4 == text.size() || !std::isdigit(uint8_t(text[i + 4])));
}

// Position of the last '*' outside of comments, or npos.
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

// Whether a line begins with a name: an extended command such as RESPOND, or a macro.
inline bool has_name(std::string_view text) {
  const auto in_name = [&](size_t i) { return std::isalpha(uint8_t(text[i])) || text[i] == '_'; };
  return text.size() > 1 && in_name(0) && in_name(1);
}

// End of the quoted value that begins at `at`; npos if no quoted value begins there, as in "Bob's".
// Within ", \" is a quotation mark.
inline size_t closing_quote(std::string_view text, size_t at) {
  const char quote = text[at];
  if (quote != '"' && quote != '\'') return std::string_view::npos;
  if (at > 0 && text[at - 1] != '=' && !std::isspace(uint8_t(text[at - 1])))
    return std::string_view::npos;
  for (size_t i = at + 1; i < text.size(); ++i) {
    if (text[i] == quote) return i;
    if (text[i] == '\\' && quote == '"') ++i;
  }
  return std::string_view::npos;
}

// Replaces comments in parentheses by blanks, and removes the text after ';', which is returned as
// `comment`. Quoted text is not a comment in the parameters of an extended command, nor directly
// after a letter (P"ei(v_tol=0.02)"). A parenthesis within a value of an extended command
// (SHAPER_TYPE=ei(v_tol=0.02)) is not a comment either.
inline void strip_comments(std::string& text, std::string& comment) {
  comment.clear();
  if (begins_message(text)) return;
  const bool named = has_name(text);
  size_t depth = 0;
  for (size_t i = 0; i < text.size(); ++i) {
    if (named && depth == 0) {
      const size_t close = closing_quote(text, i);
      if (close != std::string::npos) {
        i = close;
        continue;
      }
    }
    if (!named && depth == 0 && i > 0 && text[i] == '"' && std::isalpha(uint8_t(text[i - 1]))) {
      const size_t close = text.find('"', i + 1);
      if (close != std::string::npos) {
        i = close;
        continue;
      }
    }
    if (text[i] == ';' && depth == 0) {
      comment = text.substr(i + 1);
      text.resize(i);
      break;
    }
    const bool within_value = named && depth == 0 && i > 0 && !std::isspace(uint8_t(text[i - 1]));
    if (text[i] == '(' && !within_value) ++depth;
    bool hide = depth > 0;
    if (text[i] == ')' && depth > 0) --depth;
    if (hide) text[i] = ' ';
  }
  while (!text.empty() && std::isspace(uint8_t(text.back()))) text.pop_back();
}

// Splits a text into words: a letter and a decimal number, with blanks allowed between them.
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

// A word of a command that the host carries out. `letter` is in upper case, or a character that
// starts no word.
struct TextWord {
  std::string letter;
  std::optional<double> number;     // NaN for `nan`
  std::optional<std::string> text;  // the number as it is written, or the text in quotes
};

// Splits the text of a command into words. A word may also have a text in quotes, or `nan`.
// Comments in parentheses are skipped.
inline std::vector<TextWord> split_text(std::string_view text) {
  std::vector<TextWord> words;
  const auto space = [&](size_t i) { return i < text.size() && std::isspace(uint8_t(text[i])); };
  const auto nan = [&](size_t i) {
    return i + 3 <= text.size() && std::tolower(uint8_t(text[i])) == 'n' &&
           std::tolower(uint8_t(text[i + 1])) == 'a' && std::tolower(uint8_t(text[i + 2])) == 'n' &&
           (i + 3 == text.size() || (!std::isalnum(uint8_t(text[i + 3])) && text[i + 3] != '_'));
  };
  for (size_t i = 0; i < text.size();) {
    if (space(i)) {
      ++i;
      continue;
    }
    if (text[i] == '(') {
      for (size_t depth = 0; i < text.size();) {
        const char c = text[i++];
        depth += size_t(c == '(') - size_t(c == ')');
        if (depth == 0) break;
      }
      continue;
    }
    TextWord word;
    const size_t bytes = text[i] == '"' ? 0 : character_at(text, i).second;
    word.letter = bytes == 0 ? "\"" : readable(text.substr(i, bytes));
    i += bytes;
    const bool begins = bytes == 1 && std::isalpha(uint8_t(text[i - 1]));
    if (begins) word.letter[0] = char(std::toupper(uint8_t(word.letter[0])));
    size_t at = i;
    while (begins && space(at)) ++at;
    const char *p = text.data() + at, *end = text.data() + text.size();
    double number = 0;
    if (at < text.size() && (begins || bytes == 0) && text[at] == '"') {
      const size_t close = std::min(text.find('"', at + 1), text.size());
      if (close < text.size()) word.text = readable(text.substr(at + 1, close - at - 1));
      i = close + 1;
    } else if (begins && read_number(p, end, number)) {
      word.number = number;
      i = size_t(p - text.data());
      word.text = std::string(text.substr(at, i - at));
    } else if (begins && nan(at)) {
      word.number = std::numeric_limits<double>::quiet_NaN();
      word.text = std::string(text.substr(at, 3));
      i = at + 3;
    }
    words.push_back(std::move(word));
  }
  return words;
}

}  // namespace passo
