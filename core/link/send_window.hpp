// Frames on their way to the board: numbered, kept until the board acknowledges them, and sent
// again if they are lost.
#pragma once
#include <cstdint>

#include "link/device.hpp"
#include "link/frame.hpp"

namespace passo::wire {

// The retransmission timer is that of RFC 6298 (smoothed round trip plus four times its variation),
// bounded by 25 ms and 5 s, adapted to a dedicated line, where losses are never congestion and a
// step is due at the end of the horizon: - it runs from when the frame's last byte has gone out,
// which no round trip contains either; - it doubles only while the board has not answered at all,
// or after kSteady silent repetitions,
//   and any good frame of the board ends that;
// - where a board refuses copies of what it had, their time since the first sending counts as a
//   round trip. RFC 6298 waits longer instead until one can be measured. The refusal must come
//   later than the answer, as the copy left later than the first: where answers were lost, it is
//   the copies that are answered, and all of that comes at once.
class Window {
 public:
  static constexpr uint64_t kBlocks = 12;
  // A frame under construction may overrun its end by a command.
  static constexpr size_t kOverrun = 24;
  // Repetitions at a constant distance. At the shortest distance they take 100 ms; each command
  // leaves earlier than that before it is due.
  static constexpr int kSteady = 4;
  // Fractions of the minimum wait for an answer: an answer that is late by less than the first
  // counts as usual; answers within the second came together.
  static constexpr Ticks kUsualShare = 10, kApartShare = 2;

  explicit Window(double clock_hz)
      : rto_min_(Ticks(0.025 * clock_hz)), rto_max_(Ticks(5 * clock_hz)),
        rto_start_(Ticks(0.1 * clock_hz)), rto_(rto_start_) {}

  // Bytes that the board can buffer before it processes them; 0: no such limit.
  void set_receive_window(size_t bytes) { receive_window_ = bytes; }

  // Ticks that a byte takes on the line; 0: negligible.
  void set_byte_ticks(double ticks) { byte_ticks_ = ticks; }

  // Drops all unanswered frames: the board restarts and may count from any number.
  void restart();

  bool room(size_t payload) const {
    if (next_ - acked_ >= (synchronous_ ? kBlocks : 1) || acked_ < urgent_) return false;
    return receive_window_ == 0 || bytes_ == 0 || bytes_ + kFrameMin + payload <= receive_window_;
  }
  bool idle() const { return next_ == acked_; }
  // Some frames that the board has not acknowledged were sent more than once.
  bool resending() const { return !idle() && blocks_[acked_ & kSequenceMask].again; }
  // The board has refused a frame, which poll() sends again.
  bool refused() const { return resend_; }
  uint64_t next() const { return next_; }
  uint64_t acked() const { return acked_; }
  uint64_t retransmitted_bytes() const { return retransmitted_bytes_; }
  // Payload of the next frame, to be filled before seal(): kPayloadMax + kOverrun bytes.
  uint8_t* payload() { return block(next_).data + kHeader; }

  // Completes the next frame and sends it.
  void seal(size_t payload, Ticks now, Bytes& out);

  // Replaces all frames that the board has not acknowledged, and the next one, by `payload`: the
  // board accepts this frame next. poll() repeats it at short intervals, and sends nothing new
  // until the board has it. Returns false while the board's first answer is outstanding: then call
  // it again after that answer.
  bool replace(const Bytes& payload);

  // A good frame came from the board. `empty`: an acknowledgement without content; the second with
  // the same number is a refusal. Returns false if the number is impossible; then the frame is
  // ignored.
  bool acknowledge(uint8_t sequence, bool empty, Ticks now);

  // Sends due frames again. Call it before seal().
  void poll(Ticks now, Bytes& out);
  Ticks deadline() const { return idle() ? kNever : deadline_; }
  // The frame was sent again, or is too old to be known.
  bool repeated(uint64_t number) const;
  // The frame was the first after a restart: an answer to it may be that to another one.
  bool opening(uint64_t number) const { return blocks_[number & kSequenceMask].opening; }
  size_t length(uint64_t number) const { return blocks_[number & kSequenceMask].length; }
  Ticks sent_at(uint64_t number) const { return blocks_[number & kSequenceMask].sent; }

 private:
  struct Block {
    uint8_t data[kFrameMax + kOverrun];
    uint8_t length = 0;
    bool again = false;  // also of numbers that renumbering has left out, and of the first
    bool opening = false;
    Ticks sent = 0, gone = 0;  // time of its first sending; and when its last byte left then
  };

  Block blocks_[kSequenceMask + 1];
  uint64_t next_ = 1, acked_ = 1;  // of the next frame; of the oldest one not acknowledged
  uint64_t last_ack_ = 1, ignored_ = 0;
  uint64_t urgent_ = 0;  // frames before this are short and must not wait
  size_t bytes_ = 0, receive_window_ = 0;
  bool synchronous_ = false, resend_ = false, measured_ = false;
  Ticks rto_min_, rto_max_, rto_start_, rto_, base_ = 0, deadline_ = kNever;
  Ticks smooth_ = 0, variation_ = 0;
  double byte_ticks_ = 0;
  Ticks line_free_ = 0;      // when the last byte so far has left
  int silent_ = 0;           // repetitions since the board last answered
  Ticks doubtful_ = kNever;  // from the first sending of a repeated frame to its answer
  Ticks apart_ = 0;          // frames before this came with that answer
  Ticks copied_ = 0;         // when the last copy had left
  uint64_t retransmitted_bytes_ = 0;

  Ticks patience() const { return acked_ < urgent_ ? rto_min_ : rto_; }
  Block& block(uint64_t number) { return blocks_[number & kSequenceMask]; }

  // Returns when the last of these bytes has left.
  Ticks on_the_line(size_t bytes, Ticks now);

  void renumber(uint64_t number);
  void measure(Ticks trip);
};

}  // namespace passo::wire
