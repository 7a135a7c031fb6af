// Converts planned messages to commands of one board. It adds ids and oids, decides when a command
// is sent, and counts the move queue entries in use.
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
  // A message is sent between kHorizon and kHorizon - kQuantum before its clock, or later if it is
  // planned later. Within this time it waits until its frame is full.
  static constexpr double kHorizonSeconds = 0.150, kQuantumSeconds = 0.025;
  static constexpr size_t kMaxCommitBytes = 2 + 5 + 5 + 1 + 2;  // a query may follow
  static constexpr size_t kMaxCommandBytes = 2 + 5 + 5 + 1 + 2 + kVlqRoom;

  explicit JobStream(double clock_hz);
  ~JobStream();

  // Adds a motor; `target` is that of Message::target. Throws std::invalid_argument if the board
  // does not have a command.
  void add_stepper(const Formats& commands, size_t target, const std::string& name, uint32_t oid,
                   bool invert);
  // The board takes commits. Then a message is sent `horizon` ticks before its end, so that
  // messages at the board never delay a cut. The commit message, which makes them valid, is sent
  // later.
  void use_commits(const Formats& commands, Ticks horizon);
  // The board was armed: the messages that it has received before belong to no commit.
  void reset_commits() { staged_ = kNever; }
  // From now on the messages have clocks of another board. `tolerance`: maximum additional error of
  // a step, in ticks of this board.
  Retimer& retime(double tolerance);
  Retimer* retimer() { return retimer_.get(); }
  // Adds a pin like add_stepper(). `inverted_full`: value of full scale, if the pin is active low;
  // else 0. `longest`: if the pin is on for this many ticks without a new value, the board shuts
  // down; 0: it does not.
  void add_pin(const Formats& commands, size_t target, const std::string& name, uint32_t oid,
               PinKind kind, uint32_t inverted_full, Ticks longest);
  // Sets the kickstart of a pin.
  void set_kick(size_t target, Kick kick);
  // The board clock at which the value of a pin must be sent again, so that the board does not time
  // out; kNever if there is no such pin.
  Ticks renew_at() const;
  // The command that sends the value of a pin again at board clock `now`, after all commands in
  // transit; empty if none is due.
  Bytes renew(Ticks now);
  // The value in the command for `value` of a pin.
  static uint32_t on_wire(uint32_t value, uint32_t inverted_full);
  // The last value of a pin that was sent, before inversion.
  uint32_t pin_value(size_t target) const { return pins_.at(target).value; }
  // Number of move queue entries of the board that this stream may use.
  void set_slots(size_t slots);
  void set_queue(MessageQueue* queue) { queue_ = queue; }

  // Starts: clock 0 of the job is the clock `base` of the board.
  void start(Ticks base);
  void stop() { running_ = false; }
  // Continues after stop(). The board has dropped all commands that it had not executed.
  void resume();
  bool running() const { return running_; }
  Ticks base() const { return base_; }
  uint64_t hash() const { return hash_.value(); }
  uint64_t queue_steps() const { return queue_steps_; }
  uint64_t messages() const { return messages_; }
  // The commands that set the clock of every motor before its first step.
  std::vector<Bytes> resets(Ticks clock) const;

  // dry: no command is due. full: the next command does not fit. complete: the next message is a
  // commit message, which may not be sent yet.
  enum class Fill : uint8_t { dry, full, complete };
  // Whether a commit message may be sent. `and_ask`: with a survive_query after it.
  enum class Word : uint8_t { no, yes, and_ask };
  // Appends commands that may be sent at board clock `now` to a payload of `size` bytes, which has
  // space for kPayloadMax + kMaxCommandBytes. `first` becomes the clock of the most urgent message
  // in the frame, and `need` the clock at which the board needs it. `commit(serial, rest)` is
  // called for each commit message, and decides whether it may be sent. If not, fill() ends before
  // it.
  using Ask = std::function<Word(uint32_t serial, bool rest)>;
  Fill fill(uint8_t* payload, size_t& size, Ticks& first, Ticks& need, Ticks now,
            const Ask& commit);

  // The latest board clock at which a frame must be sent whose most urgent message is due at
  // `first`.
  Ticks must_leave(Ticks first) const { return first - horizon_ + quantum_; }
  // Whether the next message waits for a free move queue entry.
  bool short_of_slots() const { return slot_wait_ != kNever; }
  // Board clock at which fill() should be called next.
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
  bool kicks_ = false;       // a pin has a kickstart
  bool renews_ = false;      // a pin must be renewed regularly
  bool complete_ = false;    // all messages before a commit message are sent
  std::vector<Ticks> ends_;  // board clocks at which move queue entries become free; unordered
  size_t slots_ = 0;
  Ticks slot_wait_ = kNever;
  Ticks staged_ = kNever;  // clock of the first message of the incomplete commit
  MessageQueue* queue_ = nullptr;
  bool running_ = false;
  Ticks base_ = 0;
  std::unique_ptr<Retimer> retimer_;  // null if clocks are those of this board
  StreamHash hash_;
  uint64_t queue_steps_ = 0, messages_ = 0;

  static Prefix prefix(const Formats& commands, const std::string& name, uint32_t oid);
  // The clock by which a message is sent kHorizon in advance.
  Ticks due(const Message& m) const { return commits_ ? m.end_clock : m.clock; }
  // Adds a message to the stream hash, with its clock before retiming, so that the hash does not
  // depend on the error of a board's clock.
  void count(const Message& m);
  // Retimes the next message, if it is due and all earlier ones are sent.
  void retime(Ticks limit);
  static Prefix prefix(const Formats& commands, const std::string& name);
  static uint8_t* put(uint8_t* p, const Prefix& prefix);
  uint8_t* encode(const Message& m, uint8_t* p) const;
  static uint8_t* put_value(uint8_t* p, const Pin& pin, Ticks clock, uint32_t value);
  // The pin whose kickstart ends first, at or before this board clock, or null.
  Pin* kicked_until(Ticks clock);
  // The clock at which the board needs a message. A move is needed at its first step. A commit
  // message is needed at the first step among its moves, or at the clock of the commit before, at
  // which the board would brake.
  Ticks needed_at(const Message& m);
  // Frees the move queue entries of commands that are executed by `now`. Returns whether one is
  // free.
  bool free_slots(Ticks now);
};

}  // namespace passo::wire
