// How long before its time each frame of a job is at the board, and the cause if that is little.
#pragma once
#include <array>
#include <cstdint>
#include <utility>

#include "link/device.hpp"

namespace passo::wire {

// Why a frame was not there sooner: its moves were planned late; the program did not run; the link
// carries no more bytes; bytes got lost; the board had no slot.
enum class Cause : uint8_t { plan, stall, bytes, retransmits, slots };
inline constexpr size_t kCauses = 5;

// Of a frame: how long before the clock of its most urgent message it arrived, and what delayed it
// for the longest: `held` ticks of the time since it should have left, or all of a stall.
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
  void restart();
  // The link looks again: it should have done so by `due`.
  void woke(Ticks due, Ticks clock);
  // It has sent all that it could; this keeps it from sending more (plan: nothing more is due).
  void looked(Cause reason, Ticks clock);
  // A frame leaves that should have left at `must` and is useless after `need` (kNever: no message
  // of the job is in it).
  void left(uint64_t number, Ticks must, Ticks need, Ticks clock);
  // The board has it; `again`: not all copies arrived.
  void arrived(uint64_t number, bool again, Ticks clock);

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

  void hold(Cause cause, Ticks from, Ticks until);
  Ticks overlap(Cause cause, Ticks from, Ticks until) const;
};

}  // namespace passo::wire
