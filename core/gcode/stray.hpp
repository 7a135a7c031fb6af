// Finds characters that are not G-code, in a line that cannot be read or would be misread: `E31,0`,
// `X1.2.3`, `#1=5`, `M104 S200 — hot`.
#pragma once
#include <algorithm>
#include <cctype>
#include <cstdint>
#include <string>
#include <string_view>

#include "gcode/utf8.hpp"

namespace passo {

struct Stray {
  std::string token;  // the text around the character, up to the next blanks, in UTF-8; U+FFFD for
                      // invalid bytes
  int64_t code = 0;  // of the character; negative for a byte that is not UTF-8; 0 if none was found
};

// Whether the text is UTF-16, as some editors save it: it has a byte order mark, or every second
// byte is 0.
inline bool utf_16(std::string_view line) {
  if (line.substr(0, 2) == "\xff\xfe" || line.substr(0, 2) == "\xfe\xff") return true;
  bool zeros[2] = {true, true}, others[2] = {true, true};
  for (size_t i = 0; i < line.size(); ++i) {
    zeros[i % 2] = zeros[i % 2] && line[i] == 0;
    others[i % 2] = others[i % 2] && line[i] != 0;
  }
  return line.size() > 2 && ((zeros[0] && others[1]) || (others[0] && zeros[1]));
}

// Dashes, quotes, blanks and full-width letters that editors and web pages insert instead of ASCII.
inline bool typographic(int64_t code) {
  return code == 0xa0 || code == 0xab || code == 0xad || code == 0xbb || code == 0x1680 ||
         code == 0x180e || (code >= 0x2000 && code <= 0x206f) || code == 0x2212 || code == 0x3000 ||
         code == 0xfeff || (code >= 0xff01 && code <= 0xff5e);
}

inline Stray stray_at(std::string_view text, size_t at, int64_t code) {
  constexpr size_t kBefore = 20, kAfter = 30;  // bytes of the token
  auto blank = [](char c) { return c == ' ' || c == '\t'; };
  size_t begin = at, end = at + character_at(text, at).second;
  while (begin > 0 && at - begin < kBefore && !blank(text[begin - 1])) --begin;
  while (begin < at && (uint8_t(text[begin]) & 0xc0) == 0x80) ++begin;
  while (end < text.size() && end - at < kAfter && !blank(text[end]))
    end += character_at(text, end).second;
  Stray stray{"", code};
  for (size_t i = begin; i < end;) {
    const auto [value, bytes] = character_at(text, i);
    stray.token += value < 0 ? "\xef\xbf\xbd" : text.substr(i, bytes);
    i += bytes;
  }
  return stray;
}

// The first character that is not G-code in the text of a command. With `any`, the text cannot be
// read at all, and every such character counts. Otherwise a character counts only if it changes the
// meaning of the text, or if it is there by mistake; a remark without `;` is ignored, for example.
// Text in quotes or in parentheses is ignored.
inline Stray find_stray(std::string_view text, bool any) {
  auto digit = [&](size_t i) { return i < text.size() && std::isdigit(uint8_t(text[i])) != 0; };
  auto letter = [&](size_t i) { return i < text.size() && std::isalpha(uint8_t(text[i])) != 0; };
  auto begins_word = [&](size_t i) {  // the letter at i
    return letter(i) && (i == 0 || !letter(i - 1));
  };
  bool decimal = false;  // the number so far contains a point
  for (size_t i = 0; i < text.size();) {
    const auto [code, bytes] = character_at(text, i);
    const bool after_word = i > 0 && (digit(i - 1) || begins_word(i - 1) || text[i - 1] == '.');
    bool found = false;
    switch (code) {
      case '"':
      case '(': {
        const size_t close = text.find(code == '"' ? '"' : ')', i + 1);
        if (close != std::string_view::npos) i = close;
        break;
      }
      case '.':
        found = decimal && (digit(i - 1) || digit(i + 1));
        decimal = true;
        break;
      case ',':
        found = any || (i > 0 && digit(i - 1) && digit(i + 1));
        break;
      case '#':
      case '[':
      case '{':
      case '=':
        found = any || (i > 0 && begins_word(i - 1));
        break;
      case ']':
      case '}':
      case '<':
      case '>':
        found = any;
        break;
      case '?':  // readable() replaces bytes that are not UTF-8 by this
        found = any || after_word;
        break;
      default:
        found = code < 0 ||
                (code >= 0x80 && (any || typographic(code) || after_word || digit(i + bytes)));
    }
    if (found) return stray_at(text, i, code);
    if (code != '.' && !digit(i)) decimal = false;
    i += code == '"' || code == '(' ? 1 : bytes;
  }
  return {};
}

}  // namespace passo
