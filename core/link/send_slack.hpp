// How long before its deadline each frame of a job arrives at the board, and the cause if that time
// is short.
#pragma once
#include <array>
#include <cstdint>
#include <utility>

#include "link/device.hpp"

namespace passo::wire {

// Why a frame did not arrive earlier: its moves were planned late; the program did not run; the
// link was saturated; bytes were lost; the board had no free slot.
enum class Cause : uint8_t { plan, stall, bytes, retransmits, slots };
inline constexpr size_t kCauses = 5;

// For a frame: how long before the clock of its most urgent message it arrived, and the cause of
// the longest delay: `held` ticks of the time since it should have left, or all of a stall.
struct Slack {
  Ticks slack = kNever, clock = 0, held = 0;
  Cause cause = Cause::plan;
};

// All times are the board's clock. The cost is per frame and per poll of the link, not per message.
class Lateness {
 public:
  // A frame with less slack than this counts as late.
  static constexpr double kLateSeconds = 0.060;

  explicit Lateness(double clock_hz)
      : late_(Ticks(kLateSeconds * clock_hz)), stall_(Ticks(kStallSeconds * clock_hz)) {}

  // Drops the frames that are on their way.
  void restart();
  // The link polls again; it should have polled by `due`.
  void woke(Ticks due, Ticks clock);
  // The link has sent everything that it could; `reason` is why it cannot send more (plan: nothing
  // more is due).
  void looked(Cause reason, Ticks clock);
  // A frame leaves that should have left at `must`, and is useless after `need` (kNever: it has no
  // message of the job).
  void left(uint64_t number, Ticks must, Ticks need, Ticks clock);
  // The frame has arrived; `again`: some copies did not arrive.
  void arrived(uint64_t number, bool again, Ticks clock);

  // The minimum slack since the last call; kNever: no frame has arrived since.
  Slack take_recent() { return std::exchange(recent_, Slack{}); }
  // The minimum of all, and how many frames were late, by cause.
  const Slack& least() const { return least_; }
  const std::array<uint64_t, kCauses>& late_frames() const { return late_frames_; }
  Ticks longest_stall() const { return longest_stall_; }

 private:
  static constexpr size_t kFrames = 16;  // more than may be on their way
  // An operating system sometimes wakes a program this late; that has no consequences.
  static constexpr double kStallSeconds = 0.005;
  struct Frame {
    Ticks must = 0, need = kNever, left = 0;
  };
  struct Span {
    Ticks from = 0, until = 0;
  };

  Ticks late_, stall_;
  std::array<Frame, kFrames> frames_{};
  std::array<Span, kCauses> spans_{};  // the last time that each cause delayed frames
  Cause reason_ = Cause::plan;
  Ticks looked_ = 0, longest_stall_ = 0;
  Slack recent_, least_;
  std::array<uint64_t, kCauses> late_frames_{};

  void hold(Cause cause, Ticks from, Ticks until);
  Ticks overlap(Cause cause, Ticks from, Ticks until) const;
};

}  // namespace passo::wire
