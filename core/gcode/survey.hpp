// The commands of a whole program that do more than move, found before it runs: one quick pass over
// its text, without positions.
#pragma once
#include <cstring>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "gcode/interpreter.hpp"

namespace passo {

// Feed it the program; `commands()` holds each command that the caller of an Interpreter would be
// handed, once for each code, as it stands first. Memory is bounded by kMostCodes.
class Survey {
 public:
  static constexpr size_t kMostCodes = 10'000;

  Survey(const Machine& machine, std::vector<double> home, const LaserWords& laser)
      : machine_(machine), splitter_(machine_, std::move(home), laser) {
    splitter_.clamp = splitter_.ignore_tools = true;
  }
  Survey(const Survey&) = delete;

  void feed(const char* data, size_t n) {
    lines_.feed(data, n);
    read();
  }
  void finish() {
    lines_.finish();
    read();
  }
  const std::vector<Event>& commands() const { return commands_; }
  // The program moves the machine.
  bool moves() const { return moves_; }

 private:
  const Machine machine_;
  Interpreter splitter_;
  Lines lines_;
  bool ended_ = false;  // by M2 or M30
  bool moves_ = false;
  std::vector<Event> commands_;
  std::unordered_map<std::string, size_t> seen_;  // by code

  static bool is_move(const char* p, const char* end) {
    return end - p >= 3 && p[0] == 'G' && p[1] >= '0' && p[1] <= '3' && p[2] == ' ';
  }
  // A line that is a comment, or one straight move or arc and nothing else.
  static bool plain(const char* p, const char* end) {
    while (p < end && (*p == ' ' || *p == '\t')) ++p;
    if (p == end || *p == ';') return true;
    if (!is_move(p, end)) return false;
    for (p += 3; p < end && *p != ';'; ++p)
      if (uint8_t(*p) >= 'a' || *p == '*' || *p == '(' || *p == 'G' || *p == 'M' || *p == 'T' ||
          *p == 'O')
        return false;
    return true;
  }

  void read() {
    const char *p, *end;
    while (!ended_ && lines_.next(p, end)) {
      moves_ = moves_ || is_move(p, end);
      if (plain(p, end)) continue;
      splitter_.feed(p, size_t(end - p));
      splitter_.feed("\n", 1);
      Found found;
      while (!ended_ && (found = splitter_.next()) != Found::need_input)
        if (found == Found::event)
          note(splitter_.event());
        else
          moves_ = moves_ || found == Found::move;
    }
  }

  void note(const Event& event) {
    std::string code = event.name;
    if (code.empty()) {
      code = event.letter + std::to_string(event.number);
      if (event.minor != 0) code += "." + std::to_string(event.minor);
    }
    ended_ = code == "M2" || code == "M30" || code == "EOF";
    if (commands_.size() >= kMostCodes || !seen_.emplace(code, commands_.size()).second) return;
    commands_.push_back(event);
    commands_.back().line = lines_.number();
  }
};

}  // namespace passo
