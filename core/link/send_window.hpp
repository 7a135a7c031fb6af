// The frames in transit to a board. Each has a number, is kept until the board acknowledges it, and
// is sent again if it is lost.
#pragma once
#include <cstdint>

#include "link/device.hpp"
#include "link/frame.hpp"

namespace passo::wire {

// The retransmission timer is that of RFC 6298: smoothed round trip plus four times its variation,
// within 25 ms and 5 s. It is adapted to a dedicated line, where a loss is never congestion, and
// where each step must arrive in time:
//
// - The timer starts when the last byte of the frame has been sent. A round trip starts there too.
// - The timeout doubles only until the board has answered once, or after kSteady repetitions
// without
//   an answer. Any valid frame from the board ends the doubling.
// - If a repeated frame is acknowledged, and its copies are refused later, the acknowledgement was
// for
//   the first sending. So the time between the two is a round trip, which RFC 6298 cannot measure.
//   If the first acknowledgement was lost, the copies are acknowledged and refused at the same
//   time.
class Window {
 public:
  static constexpr uint64_t kBlocks = 12;
  // A frame under construction may exceed its maximum length by one command.
  static constexpr size_t kOverrun = 24;
  // Number of repetitions before the timeout doubles. With the shortest timeout they take 100 ms,
  // and commands are sent earlier than that before they are due.
  static constexpr int kSteady = 4;
  // Fractions of the minimum timeout. An answer that is late by less than the first fraction may be
  // the answer to the last copy. Answers within the second fraction count as simultaneous.
  static constexpr Ticks kUsualShare = 10, kApartShare = 2;

  explicit Window(double clock_hz)
      : rto_min_(Ticks(0.025 * clock_hz)), rto_max_(Ticks(5 * clock_hz)),
        rto_start_(Ticks(0.1 * clock_hz)), rto_(rto_start_) {}

  // Bytes that the board can buffer before it processes them; 0: no such limit.
  void set_receive_window(size_t bytes) { receive_window_ = bytes; }

  // Ticks that a byte takes on the line; 0: negligible.
  void set_byte_ticks(double ticks) { byte_ticks_ = ticks; }

  // Drops all frames: the board has restarted, and its next number is unknown.
  void restart();

  bool room(size_t payload) const {
    if (next_ - acked_ >= (synchronous_ ? kBlocks : 1) || acked_ < urgent_) return false;
    return receive_window_ == 0 || bytes_ == 0 || bytes_ + kFrameMin + payload <= receive_window_;
  }
  bool idle() const { return next_ == acked_; }
  // Whether the oldest frame that is not acknowledged was sent more than once.
  bool resending() const { return !idle() && blocks_[acked_ & kSequenceMask].again; }
  // Whether the board has refused a frame, which poll() will send again.
  bool refused() const { return resend_; }
  uint64_t next() const { return next_; }
  uint64_t acked() const { return acked_; }
  uint64_t retransmitted_bytes() const { return retransmitted_bytes_; }
  // Where to write the payload of the next frame before seal(): kPayloadMax + kOverrun bytes.
  uint8_t* payload() { return block(next_).data + kHeader; }

  // Completes the next frame and sends it.
  void seal(size_t payload, Ticks now, Bytes& out);

  // Replaces all frames that the board has not acknowledged, and the next one, by `payload`, so
  // that the board accepts this payload next. poll() repeats it at short intervals, and no new
  // frame is sent until the board has acknowledged it. Returns false if the board has not answered
  // since the restart: then call it again after the first answer.
  bool replace(const Bytes& payload);

  // Handles a valid frame from the board. `empty`: it has no content. A second empty frame with the
  // same number is a refusal. Returns false if the number is impossible; then ignore the frame.
  bool acknowledge(uint8_t sequence, bool empty, Ticks now);

  // Sends due frames again. Call it before seal().
  void poll(Ticks now, Bytes& out);
  Ticks deadline() const { return idle() ? kNever : deadline_; }
  // Whether the frame was sent more than once, or is no longer known.
  bool repeated(uint64_t number) const;
  // Whether the frame was sent before the first answer after a restart. Then an answer may belong
  // to an earlier frame.
  bool opening(uint64_t number) const { return blocks_[number & kSequenceMask].opening; }
  size_t length(uint64_t number) const { return blocks_[number & kSequenceMask].length; }
  Ticks sent_at(uint64_t number) const { return blocks_[number & kSequenceMask].sent; }

 private:
  struct Block {
    uint8_t data[kFrameMax + kOverrun];
    uint8_t length = 0;
    bool again = false;  // sent more than once, or before the board's first answer
    bool opening = false;
    Ticks sent = 0, gone = 0;  // first sending: start, and end of the last byte
  };

  Block blocks_[kSequenceMask + 1];
  uint64_t next_ = 1, acked_ = 1;  // number of the next frame, of the oldest not acknowledged
  uint64_t last_ack_ = 1, ignored_ = 0;
  uint64_t urgent_ = 0;  // frames before this number are those of replace()
  size_t bytes_ = 0, receive_window_ = 0;
  bool synchronous_ = false, resend_ = false, measured_ = false;
  Ticks rto_min_, rto_max_, rto_start_, rto_, base_ = 0, deadline_ = kNever;
  Ticks smooth_ = 0, variation_ = 0;
  double byte_ticks_ = 0;
  Ticks line_free_ = 0;      // end of the last byte sent
  int silent_ = 0;           // number of repetitions since the last answer
  Ticks doubtful_ = kNever;  // a round trip, if the acknowledgement was for the first sending
  Ticks apart_ = 0;          // frames before this clock are simultaneous with that acknowledgement
  Ticks copied_ = 0;         // end of the last copy
  uint64_t retransmitted_bytes_ = 0;

  Ticks patience() const { return acked_ < urgent_ ? rto_min_ : rto_; }
  Block& block(uint64_t number) { return blocks_[number & kSequenceMask]; }

  // Sends this number of bytes on the line. Returns the end of the last one.
  Ticks on_the_line(size_t bytes, Ticks now);

  void renumber(uint64_t number);
  void measure(Ticks trip);
};

}  // namespace passo::wire
