// Finds the commands of a program other than moves before it runs: one fast pass over the text,
// without positions.
#pragma once
#include <cstring>
#include <memory>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "gcode/interpreter.hpp"
#include "gcode/subprograms.hpp"

namespace passo {

// After feed() and finish(), commands() contains each event that an Interpreter would return, once
// for each code, as it occurs first. It covers the main program and the sub-programs that it calls.
// kMaxCodes and Subprograms::kMaxBytes bound the memory.
class Survey {
 public:
  static constexpr size_t kMaxCodes = 10'000;

  // A call that fails.
  struct BadCall {
    uint32_t line;
    std::string text;
    CallFault fault;
  };

  Survey(const Machine& machine, std::vector<double> home, const LaserWords& laser)
      : machine_(machine), splitter_(machine_, std::move(home), laser) {
    splitter_.clamp = splitter_.ignore_tools = splitter_.calls_are_events = true;
  }
  Survey(const Survey&) = delete;

  void feed(const char* data, size_t n) {
    lines_.feed(data, n);
    read();
  }
  void finish() {
    lines_.finish();
    read();
    end_part();
    if (text_.size() > Subprograms::kMaxBytes) return judge(CallFault::no_file);
    subprograms_->text = std::move(text_);
    judge(CallFault::none);
  }
  // These results are complete after finish().
  const std::vector<Event>& commands() const { return commands_; }
  const std::vector<BadCall>& bad_calls() const { return bad_calls_; }
  // Whether the program moves the machine.
  bool moves() const { return moves_; }
  std::shared_ptr<const Subprograms> subprograms() const { return subprograms_; }
  LayerMark layer_mark() const { return layer_marks_.kind(); }
  // The objects that the program labels.
  const Objects& objects() const { return splitter_.objects(); }

 private:
  struct Note {
    Event event;
    size_t part;
  };
  // The main program, or a sub-program: a part of the text after an O number.
  struct Part {
    size_t first_label = 0;
    bool returns = false;
  };
  const Machine machine_;
  Interpreter splitter_;
  Lines lines_;
  bool ended_ = false;  // the main program has ended: by M2, M30 or M99
  bool moves_ = false;
  LayerMarks layer_marks_;
  std::string text_;  // text after the main program
  std::shared_ptr<Subprograms> subprograms_ = std::make_shared<Subprograms>();
  std::vector<size_t> part_of_label_;
  std::vector<Part> parts_{Part{}};
  std::vector<Note> notes_, calls_;
  std::unordered_map<std::string, size_t> seen_;  // keys are part and code
  std::vector<Event> commands_;
  std::vector<BadCall> bad_calls_;

  static bool is_move(const char* p, const char* end) {
    return end - p >= 3 && p[0] == 'G' && p[1] >= '0' && p[1] <= '3' && p[2] == ' ';
  }
  // Whether a line is a comment, or one move and nothing else.
  bool plain(const char* p, const char* end) {
    while (p < end && (*p == ' ' || *p == '\t')) ++p;
    if (p == end) return true;
    if (*p == ';') {
      layer_marks_.comment(std::string_view(p + 1, size_t(end - p - 1)));
      return true;
    }
    if (!is_move(p, end)) return false;
    for (p += 3; p < end && *p != ';'; ++p)
      if (uint8_t(*p) >= 'a' || *p == '*' || *p == '(' || *p == 'G' || *p == 'M' || *p == 'T' ||
          *p == 'O')
        return false;
    return true;
  }

  void read() {
    const char *p, *end;
    while (lines_.next(p, end)) {
      if (ended_) keep(p, end);
      moves_ = moves_ || is_move(p, end);
      if (plain(p, end)) continue;
      splitter_.feed(p, size_t(end - p));
      splitter_.feed("\n", 1);
      ParseResult found;
      while ((found = splitter_.next()) != ParseResult::need_input)
        if (found == ParseResult::event)
          note(splitter_.event());
        else  // a macro may move: its lines are known only when it runs
          moves_ = moves_ || found == ParseResult::move || found == ParseResult::macro;
    }
  }

  // Keeps a line after the main program. It belongs to a sub-program from the first label on.
  void keep(const char* p, const char* end) {
    bool program;
    uint32_t number;
    if (read_label(p, end, program, number)) {
      if (program || parts_.size() == 1) {
        end_part();
        parts_.push_back({subprograms_->labels.size()});
      }
      subprograms_->add({number, program, text_.size(), 0, lines_.number()});
      part_of_label_.push_back(parts_.size() - 1);
    }
    if (parts_.size() == 1 || text_.size() > Subprograms::kMaxBytes) return;
    text_.append(p, size_t(end - p));
    text_ += '\n';
  }
  void end_part() {
    if (parts_.size() == 1) return;
    for (size_t i = parts_.back().first_label; i < subprograms_->labels.size(); ++i)
      subprograms_->labels[i].stop = text_.size();
  }

  void note(const Event& event) {
    std::string code = event.name;
    if (code.empty()) {
      code = code_name(event.letter, event.number, event.minor);
    }
    if (ended_ && parts_.size() == 1) return;  // before the first label: never executed
    if (code == "M98") {
      if (calls_.size() < kMaxCodes) calls_.push_back(placed(event));
      return;
    }
    if (code == "M99" && event.text.empty()) {
      parts_.back().returns = true;
      ended_ = true;
      if (parts_.size() > 1) return;
    }
    ended_ = ended_ || code == "M2" || code == "M30" || code == "EOF";
    code += "\n" + std::to_string(parts_.size());
    if (notes_.size() >= kMaxCodes || !seen_.emplace(code, notes_.size()).second) return;
    notes_.push_back(placed(event));
  }
  Note placed(const Event& event) const {
    Note note{event, parts_.size() - 1};
    note.event.line = lines_.number();
    return note;
  }

  // Follows the calls, beginning at the main program, and keeps those that fail: all of them with
  // `fault`, or with CallFault::none each one with its own fault.
  void judge(CallFault fault) {
    std::vector<bool> reached(parts_.size());
    std::vector<size_t> open{0};
    reached[0] = true;
    while (!open.empty()) {
      const size_t part = open.back();
      open.pop_back();
      for (const Note& note : calls_) {
        if (note.part != part) continue;
        Call call;
        CallFault found = fault;
        if (found == CallFault::none) found = read_call(note.event.text, *subprograms_, call);
        const size_t to =
            call.label ? part_of_label_[size_t(call.label - &subprograms_->labels[0])] : 0;
        if (found == CallFault::none && !parts_[to].returns) found = CallFault::unended;
        if (found != CallFault::none)
          bad_calls_.push_back({note.event.line, note.event.text, found});
        else if (!reached[to])
          reached[to] = true, open.push_back(to);
      }
    }
    for (const Note& note : notes_)
      if (reached[note.part]) commands_.push_back(note.event);
  }
};

}  // namespace passo
