// Characters of a text that may not be UTF-8.
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

namespace passo {

// The character at `at` and its length in bytes. A byte that is not UTF-8 has a negative code.
inline std::pair<int64_t, size_t> character_at(std::string_view text, size_t at) {
  const uint8_t lead = uint8_t(text[at]);
  if (lead < 0x80) return {lead, 1};
  const size_t more = lead >= 0xf0 ? 3 : lead >= 0xe0 ? 2 : 1;
  const int64_t least = more == 3 ? 0x10000 : more == 2 ? 0x800 : 0x80;
  int64_t code = lead & (0x3f >> more);
  bool good = lead >= 0xc2 && lead < 0xf5 && at + more < text.size();
  for (size_t i = 1; good && i <= more; ++i) {
    good = (uint8_t(text[at + i]) & 0xc0) == 0x80;
    code = code << 6 | (uint8_t(text[at + i]) & 0x3f);
  }
  if (!good || code < least || code >= 0x110000 || code >> 11 == 0x1b) return {-int64_t(lead), 1};
  return {code, more + 1};
}

// The text as valid UTF-8. If it contains a byte that is not UTF-8, as in old files, each byte
// above 127 becomes '?'.
inline std::string readable(std::string_view text) {
  std::string out(text);
  for (size_t i = 0; i < text.size();) {
    const auto [code, bytes] = character_at(text, i);
    i += bytes;
    if (code >= 0) continue;
    for (char& c : out) c = uint8_t(c) < 0x80 ? c : '?';
    break;
  }
  return out;
}

}  // namespace passo
