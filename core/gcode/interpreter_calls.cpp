// M98 and M99, which call sub-programs of the same file, and the lines of macros.
#include <algorithm>
#include <iterator>
#include <utility>

#include "gcode/interpreter.hpp"

namespace passo {

// M98. Moves of a sub-program have its own line numbers, and the number of the calling line as
// main_line.
void Interpreter::run_call(std::string_view text) {
  if (calls_are_events) return emit('M', 98, 0, "", text);
  Call call;
  CallFault fault = source_        ? CallFault::no_file
                    : !subprograms ? CallFault::no_file
                                   : read_call(text, *subprograms, call);
  if (fault == CallFault::missing && ignore_calls) return emit('M', 98, 0, "", text);
  if (fault == CallFault::none && frames_of(FrameKind::subprogram) >= kMaxDepth)
    fault = CallFault::nested;
  if (fault != CallFault::none) return fail_call(fault, "M98 " + std::string(text));
  if (call.repeats == 0) return;
  Frame frame;
  frame.label = *call.label;
  frame.repeats = call.repeats;
  frames_[0].push_back(std::move(frame));
  begin_frame();
}

// M99: returns to the line after the call, or starts the next repetition of the sub-program; also
// ends a macro. Returns false outside of both.
bool Interpreter::run_return(std::string_view text) {
  auto& frames = frames_[source_];
  while (!frames.empty() && frames.back().kind == FrameKind::rest) frames.pop_back();
  if (frames.empty() || calls_are_events) return false;
  if (!text.empty()) {
    fail_call(CallFault::unreadable, "M99 " + std::string(text));
    return true;
  }
  if (--frames.back().repeats > 0)
    begin_frame();
  else
    frames.pop_back();
  return true;
}

void Interpreter::begin_frame() {
  Frame& frame = frames_[0].back();
  frame.lines = Lines(frame.label.line);
  frame.fed = frame.label.at;
  if (++idle_calls_ < kMaxIdleCalls) return;
  idle_calls_ = 0;
  fail_call(CallFault::idle, "M98 P" + std::to_string(frame.label.number));
  frames_[0].clear();
}

// Feeds more text of a sub-program. If its text ends without an M99, fails and returns to the
// caller.
void Interpreter::feed_frame() {
  static constexpr size_t kPiece = 4096;
  Frame& frame = frames_[source_].back();
  if (frame.kind != FrameKind::subprogram) return frames_[source_].pop_back();
  if (frame.fed < frame.label.stop) {
    const size_t n = std::min(kPiece, frame.label.stop - frame.fed);
    frame.lines.feed(subprograms->text.data() + frame.fed, n);
    frame.fed += n;
    return;
  }
  const std::string name = "M98 P" + std::to_string(frame.label.number);
  fail_call(CallFault::unended, name);
  frames_[0].pop_back();
}

void Interpreter::insert(std::string_view text, std::string_view code) {
  auto& frames = frames_[source_];
  auto push = [&](FrameKind kind, std::string_view lines) {
    Frame frame;
    frame.kind = kind;
    frame.lines.feed(lines.data(), lines.size());
    frame.lines.finish();
    frames.push_back(std::move(frame));
  };
  if (next_word_ > 0)
    push(FrameKind::rest, std::string_view(text_).substr(words_[next_word_].begin));
  next_word_ = 0;
  push(FrameKind::macro, text);
  frames.back().code = code;
}

void Interpreter::insert_apart(std::string_view text) {
  insert(text);
  frames_[source_].back().apart = true;
}

void Interpreter::leave_apart() {
  auto& frames = frames_[source_];
  while (!frames.empty() && !frames.back().apart) frames.pop_back();
  if (!frames.empty()) frames.pop_back();
}

void Interpreter::hand_over_macro(Interpreter& mine) {
  auto& frames = frames_[0];
  const auto macro = std::find_if(frames.begin(), frames.end(), [](const Frame& frame) {
    return frame.kind == FrameKind::macro;
  });
  if (macro == frames.end()) return;
  mine.frames_[1].assign(std::make_move_iterator(macro), std::make_move_iterator(frames.end()));
  frames.erase(macro, frames.end());
  next_word_ = 0;  // it belonged to a line of the macro
}

void Interpreter::fail_call(CallFault fault, const std::string& call) {
  fail(Fault::call, call, double(int(fault)), double(kMaxDepth));
}

}  // namespace passo
