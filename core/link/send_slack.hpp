// How long before its time each frame of a job is at the board, and what held it up where that is
// little.
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

#include "link/device.hpp"

namespace passo::wire {

// Why a frame was not there sooner: its moves were planned late; the program did not run; the link
// carries no more bytes; bytes got lost; the board had no slot.
enum class Cause : uint8_t { plan, stall, bytes, retransmits, slots };
inline constexpr size_t kCauses = 5;

// Of a frame: how long before the clock of its most urgent message it was there, and what held it
// up for the longest: `held` ticks of the time since it should have left, or all of a stall.
struct Slack {
  Ticks slack = kNever, clock = 0, held = 0;
  Cause cause = Cause::plan;
};

// All times are the board's clock. Work is done for each frame and each look of the link, none for
// each message.
class Lateness {
 public:
  // A frame with less than this to spare counts as late.
  static constexpr double kLateSeconds = 0.060;

  explicit Lateness(double clock_hz)
      : late_(Ticks(kLateSeconds * clock_hz)), stall_(Ticks(kStallSeconds * clock_hz)) {}

  // Whatever is on its way does not count any more.
  void restart() {
    for (Frame& f : frames_) f.need = kNever;
    for (Span& s : spans_) s = {};
    reason_ = Cause::plan;
  }
  // The link looks again: it should have done so by `due`.
  void woke(Ticks due, Ticks clock) {
    if (clock - due <= stall_) due = clock;
    hold(reason_, looked_, due);
    if (clock > due) {
      hold(Cause::stall, due, clock);
      longest_stall_ = std::max(longest_stall_, clock - due);
    }
    looked_ = clock;
  }
  // It has sent what it could; this keeps it from sending more (plan: nothing more is due).
  void looked(Cause reason, Ticks clock) {
    reason_ = reason;
    looked_ = clock;
  }
  // A frame leaves that should have left at `must` and is useless after `need` (kNever: no message
  // of the job is in it).
  void left(uint64_t number, Ticks must, Ticks need, Ticks clock) {
    frames_[number % kFrames] = {must, need, clock};
  }
  // The board has it; `again`: not all copies arrived.
  void arrived(uint64_t number, bool again, Ticks clock) {
    Frame& f = frames_[number % kFrames];
    if (f.need == kNever) return;
    // Its answer may have waited for this program.
    Ticks deaf = overlap(Cause::stall, f.left, clock), way = clock - f.left - deaf;
    Slack s{f.need - clock + deaf, f.need, 0, Cause::plan};
    for (size_t i = 0; i < kCauses; ++i) {
      Cause cause = Cause(i);
      Ticks held = overlap(cause, f.must, f.left);
      if (cause == (again ? Cause::retransmits : Cause::bytes)) held += way;
      if (held > s.held) s.held = held, s.cause = cause;
    }
    f.need = kNever;
    if (s.cause == Cause::stall && s.held > 0) {  // all of it, as others would see it
      const Span& stall = spans_[size_t(Cause::stall)];
      s.held = stall.until - stall.from;
    }
    if (s.slack < late_) ++late_frames_[size_t(s.cause)];
    if (s.slack < recent_.slack) recent_ = s;
    if (s.slack < least_.slack) least_ = s;
  }

  // The least slack since this was last asked; kNever: no frame has arrived since.
  Slack take_recent() { return std::exchange(recent_, Slack{}); }
  // The least of all, and how many frames were late, by cause.
  const Slack& least() const { return least_; }
  const std::array<uint64_t, kCauses>& late_frames() const { return late_frames_; }
  Ticks longest_stall() const { return longest_stall_; }

 private:
  static constexpr size_t kFrames = 16;  // more than may be on their way
  // Programs are woken so much late now and then, which costs nothing.
  static constexpr double kStallSeconds = 0.005;
  struct Frame {
    Ticks must = 0, need = kNever, left = 0;
  };
  struct Span {
    Ticks from = 0, until = 0;
  };

  Ticks late_, stall_;
  std::array<Frame, kFrames> frames_{};
  std::array<Span, kCauses> spans_{};  // the last time that each held things up
  Cause reason_ = Cause::plan;
  Ticks looked_ = 0, longest_stall_ = 0;
  Slack recent_, least_;
  std::array<uint64_t, kCauses> late_frames_{};

  void hold(Cause cause, Ticks from, Ticks until) {
    Span& s = spans_[size_t(cause)];
    if (from > s.until) s.from = from;
    s.until = std::max(from, until);
  }
  Ticks overlap(Cause cause, Ticks from, Ticks until) const {
    const Span& s = spans_[size_t(cause)];
    return std::max<Ticks>(0, std::min(s.until, until) - std::max(s.from, from));
  }
};

}  // namespace passo::wire
