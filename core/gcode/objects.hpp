// Objects of a print, as slicers label them: M486 of Marlin, EXCLUDE_OBJECT of Klipper.
#pragma once
#include <algorithm>
#include <atomic>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <deque>
#include <iterator>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "gcode/utf8.hpp"
#include "gcode/words.hpp"

namespace passo {

enum class ObjectAction : uint8_t {
  count,           // the print has at least `number` objects
  define,          // sets `centre` and `outline` of the object `name`
  begin,           // the next lines belong to object `number`, or to `name`
  name,            // names the current object
  end,             // the next lines belong to no object
  cancel,          // object `number`, or `name`
  cancel_current,  // the object that is being printed
  restore,         // object `number`, or `name`
  restore_all
};

// A command about objects. `number` is negative if the command gives a name instead.
struct ObjectOrder {
  ObjectAction action;
  int number = -1;
  std::string name, centre, outline;
};

// Whether a line begins with a command about objects, whose labels may contain comment characters.
// Returns the length of the code, else 0.
inline size_t object_code(std::string_view text) {
  static constexpr std::string_view kCodes[] = {"EXCLUDE_OBJECT_DEFINE", "EXCLUDE_OBJECT_START",
                                                "EXCLUDE_OBJECT_END", "EXCLUDE_OBJECT", "M486"};
  if (text.empty() || std::strchr("EeMm", text[0]) == nullptr) return 0;
  for (std::string_view code : kCodes) {
    if (text.size() < code.size()) continue;
    if (!std::equal(code.begin(), code.end(), text.begin(),
                    [](char a, char b) { return a == char(std::toupper(uint8_t(b))); }))
      continue;
    const char next = text.size() > code.size() ? text[code.size()] : ' ';
    const bool ends = code[0] == 'M' ? !std::isdigit(uint8_t(next)) && next != '.'
                                     : !std::isalnum(uint8_t(next)) && next != '_';
    if (ends) return code.size();
  }
  return 0;
}

// The command without its comment, which begins with a ';' outside of quotes.
inline std::string_view without_comment(std::string_view text) {
  size_t end = 0;
  for (; end < text.size() && text[end] != ';'; ++end) {
    if (text[end] != '"' && text[end] != '\'') continue;
    // A quote opens only before a value: "Bob's" contains none.
    const bool opens = end == 0 || text[end - 1] == '=' ||
                       std::toupper(uint8_t(text[end - 1])) == 'A' ||
                       std::isspace(uint8_t(text[end - 1]));
    const size_t close = opens ? text.find(text[end], end + 1) : std::string_view::npos;
    if (close != std::string_view::npos) end = close;
  }
  while (end > 0 && std::isspace(uint8_t(text[end - 1]))) --end;
  return text.substr(0, end);
}

class ObjectText {
 public:
  static constexpr int kMaxObjects = 10'000;
  static constexpr size_t kMaxNameBytes = 200;

  // Reads the actions of a command; `text` is the text after its code. Ignores parts that cannot be
  // read: a label must not stop a print.
  static std::vector<ObjectOrder> read(std::string_view code, std::string_view text) {
    return code == "M486" ? of_marlin(text) : of_klipper(code, text);
  }

 private:
  static std::string unquoted(std::string_view text) {
    while (!text.empty() && std::isspace(uint8_t(text.front()))) text.remove_prefix(1);
    while (!text.empty() && std::isspace(uint8_t(text.back()))) text.remove_suffix(1);
    if (text.size() >= 2 && (text.front() == '"' || text.front() == '\'') &&
        text.back() == text.front())
      text = text.substr(1, text.size() - 2);
    std::string name = readable(text);
    if (name.size() > kMaxNameBytes) {  // do not cut a character
      size_t stop = kMaxNameBytes;
      while (stop > 0 && (uint8_t(name[stop]) & 0xc0) == 0x80) --stop;
      name.resize(stop);
    }
    return name;
  }

  static std::vector<ObjectOrder> of_marlin(std::string_view text) {
    std::vector<ObjectOrder> orders;
    ObjectOrder label{};
    const char *p = text.data(), *end = p + text.size();
    while (p < end) {
      const char letter = char(std::toupper(uint8_t(*p++)));
      if (std::isspace(uint8_t(letter))) continue;
      if (letter == 'A') {
        const std::string_view rest(p, size_t(end - p));
        const size_t close = quoted(rest);
        label = {ObjectAction::name, -1, unquoted(rest.substr(0, close)), "", ""};
        p = close == std::string_view::npos ? end : p + close;
        continue;
      }
      if (letter == 'C') {
        orders.push_back({ObjectAction::cancel_current, -1, "", "", ""});
        continue;
      }
      while (p < end && std::isspace(uint8_t(*p))) ++p;
      double value;
      if (!read_number(p, end, value)) continue;
      const bool whole = value == std::floor(value) && std::fabs(value) <= kMaxObjects;
      const int number = whole ? int(value) : kMaxObjects;
      if (letter == 'S' && value < 0)
        orders.push_back({ObjectAction::end, -1, "", "", ""});
      else if (value >= 0 && (letter == 'S' || letter == 'P' || letter == 'U' || letter == 'T'))
        orders.push_back({letter == 'S'   ? ObjectAction::begin
                          : letter == 'P' ? ObjectAction::cancel
                          : letter == 'U' ? ObjectAction::restore
                                          : ObjectAction::count,
                          number, "", "", ""});
    }
    if (!label.name.empty())
      orders.push_back(std::move(label));  // after S: the name is that of the new object
                                           // begins
    return orders;
  }
  // The end of a quoted text at the beginning of `text`, or npos.
  static size_t quoted(std::string_view text) {
    const size_t open = text.find_first_not_of(" \t");
    if (open == std::string_view::npos || (text[open] != '"' && text[open] != '\''))
      return std::string_view::npos;
    const size_t close = text.find(text[open], open + 1);
    return close == std::string_view::npos ? close : close + 1;
  }

  // Finds the value of KEY=…, which is in quotes or ends before the next key.
  static bool value_of(std::string_view text, std::string_view key, std::string& value) {
    size_t at = 0;
    while (at < text.size()) {
      while (at < text.size() && std::isspace(uint8_t(text[at]))) ++at;
      const size_t begin = at;
      while (at < text.size() && text[at] != '=' && !std::isspace(uint8_t(text[at]))) ++at;
      const std::string_view name = text.substr(begin, at - begin);
      while (at < text.size() && std::isspace(uint8_t(text[at]))) ++at;
      if (at >= text.size() || text[at] != '=') continue;
      size_t stop = end_of_value(text, ++at);
      const bool found = name.size() == key.size() &&
                         std::equal(key.begin(), key.end(), name.begin(), [](char a, char b) {
                           return a == char(std::toupper(uint8_t(b)));
                         });
      if (found) {
        value = std::string(text.substr(at, stop - at));
        return true;
      }
      at = stop;
    }
    return false;
  }
  static size_t end_of_value(std::string_view text, size_t at) {
    if (const size_t close = quoted(text.substr(at)); close != std::string_view::npos)
      return at + close;
    // A name may contain blanks: it ends before a blank that a key and '=' follow.
    for (size_t blank = at; blank < text.size(); ++blank) {
      if (!std::isspace(uint8_t(text[blank]))) continue;
      size_t key = blank + 1;
      while (key < text.size() && (std::isalnum(uint8_t(text[key])) || text[key] == '_')) ++key;
      if (key > blank + 1 && key < text.size() && text[key] == '=') return blank;
    }
    return text.size();
  }

  static std::vector<ObjectOrder> of_klipper(std::string_view code, std::string_view text) {
    std::string value;
    ObjectOrder order{ObjectAction::end, -1, "", "", ""};
    const bool named = value_of(text, "NAME", value);
    if (named) order.name = unquoted(value);
    if (code == "EXCLUDE_OBJECT_END") return {order};
    if (code == "EXCLUDE_OBJECT_DEFINE" || code == "EXCLUDE_OBJECT_START") {
      if (order.name.empty()) return {};
      order.action = code == "EXCLUDE_OBJECT_START" ? ObjectAction::begin : ObjectAction::define;
      if (value_of(text, "CENTER", value)) order.centre = unquoted(value);
      if (value_of(text, "POLYGON", value)) order.outline = readable(value);
      return {order};
    }
    auto set = [&](std::string_view key) {
      return value_of(text, key, value) && unquoted(value) != "0";
    };
    const bool back = set("RESET");
    if (!named && !back && !set("CURRENT")) return {};
    order.action = named  ? back ? ObjectAction::restore : ObjectAction::cancel
                   : back ? ObjectAction::restore_all
                          : ObjectAction::cancel_current;
    return {order};
  }
};

struct PrintObject {
  std::string name, centre, outline;  // as in the file; empty if not given
  bool cancelled = false;
};

// The objects of one print, numbered in the order of the file. All readers of the file share them.
class Objects {
 public:
  static constexpr size_t kMaxOutlineBytes = size_t(4) << 20;  // further outlines are dropped

  const std::vector<PrintObject>& all() const { return all_; }
  // A new value after each change of the objects, and for each print.
  uint64_t version() const { return version_; }
  bool cancelled(int number) const { return all_[size_t(number)].cancelled; }

  void reserve(int count) {
    count = std::min(count, ObjectText::kMaxObjects);
    if (size_t(count) > all_.size()) all_.resize(size_t(count)), renew();
  }
  // Returns the number; -1 if there are too many objects.
  int numbered(int number) {
    if (number >= ObjectText::kMaxObjects) return -1;
    reserve(number + 1);
    return number;
  }
  // The first object of this name. Without such an object, the first unnamed or a new object gets
  // the name. Returns -1 if there are too many objects.
  int named(const std::string& name) {
    if (const auto found = find(name); !found.empty()) return found.front();
    while (unnamed_ < all_.size() && !all_[unnamed_].name.empty()) ++unnamed_;
    const int number = numbered(int(unnamed_));
    if (number >= 0) call(number, name);
    return number;
  }
  void call(int number, const std::string& name) {
    if (all_[size_t(number)].name == name) return;
    all_[size_t(number)].name = name;
    renew();
  }
  void define(const ObjectOrder& order) {
    const int number = named(order.name);
    if (number < 0) return;
    PrintObject& object = all_[size_t(number)];
    const size_t before = object.centre.size() + object.outline.size();
    const size_t after = order.centre.size() + order.outline.size();
    if (outlines_ - before + after > kMaxOutlineBytes) return;
    outlines_ += after - before;
    object.centre = order.centre;
    object.outline = order.outline;
    renew();
  }
  void cancel(int number, bool cancelled) {
    if (all_[size_t(number)].cancelled == cancelled) return;
    all_[size_t(number)].cancelled = cancelled;
    renew();
  }
  void restore_all() {
    for (size_t i = 0; i < all_.size(); ++i) cancel(int(i), false);
  }
  // Copies the names and places that another reader of the same file has found.
  void learn(const Objects& other) {
    reserve(int(other.all_.size()));
    for (size_t i = 0; i < other.all_.size(); ++i) {
      const bool cancelled = all_[i].cancelled;
      all_[i] = other.all_[i];
      all_[i].cancelled = cancelled;
    }
    outlines_ = other.outlines_;
    renew();
  }
  // Numbers of the objects of this name. Upper and lower case ASCII letters are equal.
  std::vector<int> find(const std::string& name) const {
    std::vector<int> found;
    for (size_t i = 0; i < all_.size(); ++i)
      if (same(all_[i].name, name)) found.push_back(int(i));
    return found;
  }

 private:
  std::vector<PrintObject> all_;
  size_t outlines_ = 0;
  size_t unnamed_ = 0;  // all objects before this one have a name
  uint64_t version_ = renew();

  uint64_t renew() {
    static std::atomic<uint64_t> latest{0};
    return version_ = ++latest;
  }
  static bool same(const std::string& a, const std::string& b) {
    return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin(), [](char x, char y) {
             return std::toupper(uint8_t(x)) == std::toupper(uint8_t(y));
           });
  }
};

// Keeps which object each recent line of the program belongs to.
class ObjectLines {
 public:
  // Lines from `line` on belong to `object`. Line numbers must not decrease. All lines of a
  // sub-program's call have the number of the call.
  void add(uint32_t line, int object) {
    if (!starts_.empty() && starts_.back().first == line) starts_.pop_back();
    starts_.emplace_back(line, object);
    if (starts_.size() > kMaxStarts) starts_.pop_front();
  }
  void clear() { starts_.clear(); }
  // The object of a line, or -1.
  int at(uint32_t line) const {
    auto next = std::upper_bound(starts_.begin(), starts_.end(), line,
                                 [](uint32_t l, const auto& start) { return l < start.first; });
    return next == starts_.begin() ? -1 : std::prev(next)->second;
  }

 private:
  static constexpr size_t kMaxStarts = 4096;
  std::deque<std::pair<uint32_t, int>> starts_;
};

}  // namespace passo
