// Converts planned messages to the commands of one board: their id and oid, when they may leave,
// and how many move slots they hold.
#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "link/device.hpp"
#include "link/dictionary.hpp"
#include "link/fan_kickstart.hpp"
#include "link/frame.hpp"
#include "link/stream_hash.hpp"
#include "steps/message_queue.hpp"

namespace passo::wire {

class Retimer;

enum class PinKind : uint8_t { digital, pwm };

class JobStream {
 public:
  // A message leaves at most this long before its clock. It leaves at least kHorizon - kQuantum
  // before its clock, unless it was planned later: in between, it waits until a frame is full.
  static constexpr double kHorizonSeconds = 0.150, kQuantumSeconds = 0.025;
  static constexpr size_t kMaxCommitBytes = 2 + 5 + 5 + 1 + 2;  // followed by the question
  static constexpr size_t kMaxCommandBytes = 2 + 5 + 5 + 1 + 2 + kVlqRoom;

  explicit JobStream(double clock_hz);
  ~JobStream();

  // A motor or a pin of this board; targets are those of Message::target. Throws
  // std::invalid_argument if the board lacks a command.
  void add_stepper(const Formats& commands, size_t target, const std::string& name, uint32_t oid,
                   bool invert);
  // The board takes commits: a message leaves this many ticks before its end instead, so that sent
  // messages never delay a cut. The message that makes it valid is sent later.
  void use_commits(const Formats& commands, Ticks horizon);
  // The board is armed: the messages that it has received so far belong to no commit.
  void begin_commits() { staged_ = kNever; }
  // From now on the clocks of its messages are those of another board. `tolerance` of a step's
  // time, in ticks of this board.
  Retimer& retime(double tolerance);
  Retimer* retimer() { return retimer_.get(); }
  // `inverted_full`: the value at full scale of a pin that is active low; 0 for all others.
  // `longest`: the board shuts down when a pin is on for so many ticks without a renewal; 0: it
  // does not.
  void add_pin(const Formats& commands, size_t target, const std::string& name, uint32_t oid,
               PinKind kind, uint32_t inverted_full, Ticks longest);
  // The kickstart of a pin of this board. Other messages are not affected.
  void set_kick(size_t target, Kick kick);
  // The board clock at which a pin must be renewed, so that the board does not time out; kNever if
  // no pin needs it.
  Ticks renew_at() const;
  // The command for a pin that is due at board clock `now`, after all commands on their way; empty
  // if none is due.
  Bytes renew(Ticks now);
  // The value that a board receives for `value` of a pin.
  static uint32_t on_wire(uint32_t value, uint32_t inverted_full);
  // The last value of a pin that was sent, as it was before inversion.
  uint32_t pin_value(size_t target) const { return pins_.at(target).value; }
  // Move slots of the board that this stream may use at once.
  void set_slots(size_t slots);
  void set_queue(MessageQueue* queue) { queue_ = queue; }

  // Clock 0 of the job is `base` of the board.
  void start(Ticks base);
  void stop() { running_ = false; }
  // Continues after stop(): the board has dropped the commands that it had not executed.
  void go_on();
  bool running() const { return running_; }
  Ticks base() const { return base_; }
  uint64_t hash() const { return hash_.value(); }
  uint64_t queue_steps() const { return queue_steps_; }
  uint64_t messages() const { return messages_; }
  // The commands that every motor needs before its first step.
  std::vector<Bytes> resets(Ticks clock) const;

  // full: the next command did not fit. complete: the board must have all earlier messages before
  // the next one.
  enum class Fill : uint8_t { dry, full, complete };
  // Whether the message that makes a commit valid may go into a frame. `and_ask`: together with the
  // query of the executed commits.
  enum class Word : uint8_t { no, yes, and_ask };
  // Appends commands that may leave at board clock `now` to a payload of `size` bytes (room for
  // kPayloadMax + kMaxCommandBytes). `first` becomes the clock of the most urgent message in the
  // frame, `need` the clock at which the board needs it. `commit(serial, rest)` reports a commit
  // message that was put into the frame. If the commit message may not be sent, nothing after it is
  // sent until fill() is called again.
  using Ask = std::function<Word(uint32_t serial, bool rest)>;
  Fill fill(uint8_t* payload, size_t& size, Ticks& first, Ticks& need, Ticks now,
            const Ask& commit);

  // A frame whose most urgent message is due at `first` must leave at this board clock at the
  // latest.
  Ticks must_leave(Ticks first) const { return first - horizon_ + quantum_; }
  // The next message waits for a slot.
  bool short_of_slots() const { return slot_wait_ != kNever; }
  // Board clock of the next useful call of fill().
  Ticks wake() const;

 private:
  static constexpr double kMarginSeconds =
      0.001;  // maximum error of the estimate of the board's clock
  struct Prefix {
    uint8_t bytes[7], size;
  };
  struct Stepper {
    Prefix queue_step, set_dir, reset_clock, tail;
    uint32_t oid;
    uint64_t name;
    bool invert;
  };
  struct Pin {
    Prefix update;
    uint64_t name;
    uint32_t inverted_full;
    Ticks longest;
    Kick kick{};
    uint32_t value = 0;
    Ticks sent_at = 0;  // board clock of the last command

    void sent(Ticks clock, uint32_t what) { sent_at = clock, value = what; }
  };

  Ticks horizon_, quantum_, margin_;
  std::vector<Stepper> steppers_;
  std::vector<Pin> pins_;
  Prefix commit_{}, query_{};
  bool commits_ = false;
  bool kicks_ = false;       // of some pin
  bool renews_ = false;      // a pin must be renewed regularly
  bool complete_ = false;    // commands at the board, or on their way, wait for a commit
  std::vector<Ticks> ends_;  // board clocks at which used slots become free; unordered
  size_t slots_ = 0;
  Ticks slot_wait_ = kNever;
  Ticks staged_ = kNever;  // clock of the first message of the incomplete commit
  MessageQueue* queue_ = nullptr;
  bool running_ = false;
  Ticks base_ = 0;
  std::unique_ptr<Retimer> retimer_;  // none: clocks are this board's own
  StreamHash hash_;
  uint64_t queue_steps_ = 0, messages_ = 0;

  static Prefix prefix(const Formats& commands, const std::string& name, uint32_t oid);
  // The rule for when a message leaves.
  Ticks due(const Message& m) const { return commits_ ? m.end_clock : m.clock; }
  // The stream hash covers the clocks of the timeline, so the error of a board's clock does not
  // change it.
  void count(const Message& m);
  // Takes a message, if one is due and all earlier ones are on their way.
  void retime(Ticks limit);
  static Prefix prefix(const Formats& commands, const std::string& name);
  static uint8_t* put(uint8_t* p, const Prefix& prefix);
  uint8_t* encode(const Message& m, uint8_t* p) const;
  static uint8_t* put_value(uint8_t* p, const Pin& pin, Ticks clock, uint32_t value);
  // The pin whose kickstart ends first, at or before that board clock; null: none.
  Pin* kicked_until(Ticks clock);
  // The board needs moves by their first step, with the messages before them. Staged moves need
  // their commit by then too, and by the clock of the commit before, at which the board would
  // brake.
  Ticks needed_at(const Message& m);
  // Takes back the slots of commands that are done by `now`; returns false if no slot is free.
  bool free_slots(Ticks now);
};

}  // namespace passo::wire
