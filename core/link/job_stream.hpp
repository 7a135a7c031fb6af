// Planned messages → commands of one board: which id and oid they get, when they may leave, and how
// many move slots they hold.
#pragma once
#include <algorithm>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "link/device.hpp"
#include "link/dictionary.hpp"
#include "link/fan_kickstart.hpp"
#include "link/frame.hpp"
#include "link/retimer.hpp"
#include "link/stream_hash.hpp"
#include "steps/message_queue.hpp"

namespace passo::wire {

enum class PinKind : uint8_t { digital, pwm };

class JobStream {
 public:
  // A message leaves at most this long before its clock, and at least kHorizon - kQuantum unless it
  // was planned later: in between it waits for others to fill a frame.
  static constexpr double kHorizonSeconds = 0.150, kQuantumSeconds = 0.025;
  static constexpr size_t kLongestCommit = 2 + 5 + 5 + 1 + 2;  // with the question behind it
  static constexpr size_t kLongestCommand = 2 + 5 + 5 + 1 + 2 + kVlqRoom;

  explicit JobStream(double clock_hz)
      : horizon_(Ticks(kHorizonSeconds * clock_hz)), quantum_(Ticks(kQuantumSeconds * clock_hz)),
        margin_(Ticks(kMarginSeconds * clock_hz)) {}

  // A motor or a pin of this board; targets are those of Message::target. Throws
  // std::invalid_argument if the board lacks a command.
  void add_stepper(const Formats& commands, size_t target, const std::string& name, uint32_t oid,
                   bool invert) {
    if (steppers_.size() <= target) steppers_.resize(target + 1);
    steppers_[target] = {prefix(commands, "queue_step", oid),
                         prefix(commands, "set_next_step_dir", oid),
                         prefix(commands, "reset_step_clock", oid),
                         {},
                         oid,
                         StreamHash::of_name(name),
                         invert};
  }
  // The board takes commits: a message leaves so many ticks before its end instead, so that a cut
  // is never put off by what has left. Early enough it is: the word that makes it valid comes
  // later.
  void use_commits(const Formats& commands, Ticks horizon) {
    commit_ = prefix(commands, "survive_commit");
    query_ = prefix(commands, "survive_query");
    for (Stepper& s : steppers_) s.tail = prefix(commands, "survive_tail", s.oid);
    horizon_ = horizon;
    commits_ = true;
  }
  // The board is armed: what it has been sent so far is in no commit.
  void begin_commits() { staged_ = kNever; }
  // The clocks of its messages are another board's from now on; `tolerance` is that of a step's
  // time, in ticks of this board.
  Retimer& retime(double tolerance) {
    if (!retimer_) retimer_ = std::make_unique<Retimer>(tolerance);
    return *retimer_;
  }
  Retimer* retimer() { return retimer_.get(); }
  // `inverted_full`: the value at full scale of a pin that is on when low; 0 of all others.
  // `longest`: the board shuts down when a pin is on for so many ticks without a word of the host;
  // 0: it does not.
  void add_pin(const Formats& commands, size_t target, const std::string& name, uint32_t oid,
               PinKind kind, uint32_t inverted_full, Ticks longest) {
    if (pins_.size() <= target) pins_.resize(target + 1);
    pins_[target] = {
        prefix(commands, kind == PinKind::pwm ? "queue_pwm_out" : "queue_digital_out", oid),
        StreamHash::of_name(name), inverted_full, longest};
    renews_ = renews_ || longest > 0;
  }
  // How a pin of this board is started. Other messages know nothing of that.
  void set_kick(size_t target, Kick kick) {
    pins_.at(target).kick = kick;
    kicks_ = kicks_ || kick;
  }
  // The board clock at which a pin must be told its value again, lest the board think that nobody
  // is there; kNever if none.
  Ticks renew_at() const {
    Ticks next = kNever;
    if (!renews_ || !running_) return next;
    for (const Pin& pin : pins_)
      if (pin.longest > 0 && pin.value > 0) next = std::min(next, pin.told + pin.longest / 2);
    return next;
  }
  // The command for a pin that is due at board clock `now`, behind all that is on its way; empty if
  // none is.
  Bytes renew(Ticks now) {
    Bytes payload;
    if (renew_at() > now) return payload;
    for (Pin& pin : pins_) {
      if (pin.longest == 0 || pin.value == 0 || now < pin.told + pin.longest / 2) continue;
      pin.told = std::max(pin.told + 1, now + 2 * quantum_);
      uint8_t buffer[kLongestCommand];
      payload.assign(buffer, put_value(buffer, pin, pin.told, pin.value));
      break;
    }
    return payload;
  }
  // What a board is told for `value` of a pin.
  static uint32_t on_wire(uint32_t value, uint32_t inverted_full) {
    return inverted_full ? inverted_full - std::min(value, inverted_full) : value;
  }
  // The last value of a pin that was sent, as it was before inversion.
  uint32_t pin_value(size_t target) const { return pins_.at(target).value; }
  // Slots of the board that this stream may hold at once.
  void set_slots(size_t slots) {
    slots_ = slots;
    ends_.reserve(slots);
  }
  void set_queue(MessageQueue* queue) { queue_ = queue; }

  // Clock 0 of the job is `base` of the board.
  void start(Ticks base) {
    base_ = base;
    hash_ = StreamHash();
    queue_steps_ = messages_ = 0;
    staged_ = kNever;
    for (Pin& pin : pins_) {
      pin.kick.forget();
      pin.told = 0;  // the board may have begun anew
    }
    running_ = true;
  }
  void stop() { running_ = false; }
  // Goes on after stop(): the board has forgotten what it had not done.
  void go_on() {
    ends_.clear();
    staged_ = kNever;
    complete_ = false;
    if (retimer_) retimer_->begin_anew();
    for (Pin& pin : pins_)
      if (pin.kick.interrupt() || pin.longest > 0) pin.value = 0;  // the board has switched it off
    running_ = true;
  }
  bool running() const { return running_; }
  Ticks base() const { return base_; }
  uint64_t hash() const { return hash_.value(); }
  uint64_t queue_steps() const { return queue_steps_; }
  uint64_t messages() const { return messages_; }
  // The commands that every motor needs before its first step.
  std::vector<Bytes> resets(Ticks clock) const {
    std::vector<Bytes> all;
    for (const Stepper& stepper : steppers_) {
      if (stepper.reset_clock.size == 0) continue;
      uint8_t buffer[kLongestCommand];
      uint8_t* p = put_vlq(put(buffer, stepper.reset_clock), uint32_t(clock));
      all.emplace_back(buffer, p);
    }
    return all;
  }

  // full: the next command did not fit. complete: the board is to have all so far before the next
  // one.
  enum class Fill : uint8_t { dry, full, complete };
  // Whether the word that makes a commit valid may go into a frame. `and_ask`: with the question
  // for what the board has done.
  enum class Word : uint8_t { no, yes, and_ask };
  // Appends commands that may leave at board clock `now` to a payload of `size` bytes (room for
  // kPayloadMax + kLongestCommand). `first` becomes the clock of the most urgent message in the
  // frame, `need` the clock at which the board needs it. `commit(serial, rest)` tells of a Word,
  // which is in the frame then; if it may not go, nothing behind it leaves until fill() is called
  // again.
  template <typename Commit>
  Fill fill(uint8_t* payload, size_t& size, Ticks& first, Ticks& need, Ticks now, Commit&& commit) {
    slot_wait_ = kNever;
    complete_ = false;
    if (!running_ || !queue_) return Fill::dry;
    auto held = queue_->hold();
    const Ticks limit = now + horizon_ - base_;
    for (;;) {
      if (retimer_) retime(limit);
      MessageQueue& queue = retimer_ ? retimer_->ready() : *queue_;
      const Ticks next = queue.empty() ? kNever : due(queue.front());
      if (Pin* pin = kicks_ ? kicked_until(std::min(next, limit) + base_) : nullptr) {
        if (ends_.size() >= slots_ && !free_slots(now)) break;
        Ticks clock = std::max({pin->kick.end(), pin->told + 1, now + 2 * quantum_});
        uint8_t* end = put_value(payload + size, *pin, clock, pin->kick.asked());
        if (size_t(end - payload) > kPayloadMax) return Fill::full;
        size = size_t(end - payload);
        first = std::min(first, clock);
        need = std::min(need, clock);
        ends_.push_back(clock);
        pin->tell(clock, pin->kick.asked());
        pin->kick.over();
        continue;
      }
      if (next > limit) break;
      const Message& m = queue.front();
      const bool commits = m.kind == MessageKind::commit;
      if (commits && size + kLongestCommit > kPayloadMax) return Fill::full;
      Word word = commits ? commit(m.interval, m.dir != 0) : Word::yes;
      if (word == Word::no) {
        complete_ = true;
        return Fill::complete;
      }
      bool slot = m.kind == MessageKind::queue_step || m.kind == MessageKind::pin ||
                  m.kind == MessageKind::tail || (commits_ && m.kind == MessageKind::reset_clock);
      if (slot && ends_.size() >= slots_ && !free_slots(now)) break;
      uint8_t* end = nullptr;
      if (m.kind == MessageKind::pin) {
        Pin& pin = pins_[m.target];
        // The end of a kick and what is told again come at clocks of their own.
        const Ticks clock = std::max(m.clock + base_, pin.told);
        Kick kick = pin.kick;
        uint32_t value = kick.told(m.interval, pin.value, clock);
        end = put_value(payload + size, pin, clock, value);
        if (size_t(end - payload) > kPayloadMax) return Fill::full;
        pin.kick = kick;
        pin.tell(clock, value);
      } else {
        end = encode(m, payload + size);
        if (word == Word::and_ask) end = put(end, query_);
        if (size_t(end - payload) > kPayloadMax) return Fill::full;
      }
      size = size_t(end - payload);
      first = std::min(first, due(m) + base_);
      need = std::min(need, needed_at(m));
      if (slot) ends_.push_back(std::max(m.clock, m.end_clock) + base_);
      queue_steps_ += m.kind == MessageKind::queue_step;
      if (!retimer_) count(m);
      queue.pop();
    }
    return Fill::dry;
  }

  // A frame whose most urgent message is due at `first` must leave at this board clock at the
  // latest.
  Ticks must_leave(Ticks first) const { return first - horizon_ + quantum_; }
  // The next message has to wait for a slot.
  bool short_of_slots() const { return slot_wait_ != kNever; }
  // Board clock at which fill() is worth calling again.
  Ticks wake() const {
    if (!running_ || !queue_ || complete_) return kNever;
    auto held = queue_->hold();
    bool ready = retimer_ && !retimer_->ready().empty();
    Ticks clock = kNever;
    if (kicks_)
      for (const Pin& pin : pins_) clock = std::min(clock, pin.kick.end());
    if (ready || !queue_->empty()) {
      Ticks next = ready      ? due(retimer_->ready().front())
                   : retimer_ ? retimer_->clock_of(due(queue_->front()))
                              : due(queue_->front());
      clock = std::min(clock, next + base_);
    }
    if (clock == kNever) return kNever;
    Ticks due = must_leave(clock);
    return slot_wait_ == kNever ? due : std::max(due, slot_wait_);
  }

 private:
  static constexpr double kMarginSeconds =
      0.001;  // how wrong the estimate of the board's clock may be
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
    Ticks told = 0;  // board clock of the last word

    void tell(Ticks clock, uint32_t what) { told = clock, value = what; }
  };

  Ticks horizon_, quantum_, margin_;
  std::vector<Stepper> steppers_;
  std::vector<Pin> pins_;
  Prefix commit_{}, query_{};
  bool commits_ = false;
  bool kicks_ = false;       // of some pin
  bool renews_ = false;      // some pin is told its value again and again
  bool complete_ = false;    // what is at the board, or on its way, waits for a commit
  std::vector<Ticks> ends_;  // board clocks at which slots in use are free again; unordered
  size_t slots_ = 0;
  Ticks slot_wait_ = kNever;
  Ticks staged_ = kNever;  // clock of the first message of the commit that is not complete yet
  MessageQueue* queue_ = nullptr;
  bool running_ = false;
  Ticks base_ = 0;
  std::unique_ptr<Retimer> retimer_;  // none: clocks are this board's own
  StreamHash hash_;
  uint64_t queue_steps_ = 0, messages_ = 0;

  static Prefix prefix(const Formats& commands, const std::string& name, uint32_t oid) {
    Prefix prefix{};
    uint8_t buffer[2 * kVlqMax];
    uint8_t* end = put_vlq(put_vlq(buffer, uint32_t(commands.at(name).id)), oid);
    prefix.size = uint8_t(end - buffer);
    if (prefix.size > 4) throw std::invalid_argument("oid out of range: " + std::to_string(oid));
    std::copy(buffer, end, prefix.bytes);
    return prefix;
  }
  // What decides when a message leaves.
  Ticks due(const Message& m) const { return commits_ ? m.end_clock : m.clock; }
  // The stream is that of the timeline, however well a board's clock is known.
  void count(const Message& m) {
    if (m.kind == MessageKind::tail || m.kind == MessageKind::commit) return;
    ++messages_;
    hash_.add(m, m.kind == MessageKind::pin ? pins_[m.target].name : steppers_[m.target].name);
  }
  // Takes a message, if one is due and those before it are on their way.
  void retime(Ticks limit) {
    if (!retimer_->ready().empty() || queue_->empty()) return;
    if (retimer_->clock_of(due(queue_->front())) > limit) return;
    count(queue_->front());
    retimer_->retime(queue_->front());
    queue_->pop();
  }
  static Prefix prefix(const Formats& commands, const std::string& name) {
    Prefix prefix{};
    prefix.size = uint8_t(put_vlq(prefix.bytes, uint32_t(commands.at(name).id)) - prefix.bytes);
    return prefix;
  }
  static uint8_t* put(uint8_t* p, const Prefix& prefix) {
    std::memcpy(p, prefix.bytes, 4);
    return p + prefix.size;
  }
  uint8_t* encode(const Message& m, uint8_t* p) const {
    switch (m.kind) {
      case MessageKind::queue_step:
        p = put_vlq_any(put(p, steppers_[m.target].queue_step), m.interval);
        return put_vlq_any(put_vlq(p, m.count), uint32_t(int32_t(m.add)));
      case MessageKind::set_dir:
        return put_vlq(put(p, steppers_[m.target].set_dir),
                       uint32_t(m.dir != 0) ^ uint32_t(steppers_[m.target].invert));
      case MessageKind::reset_clock:
        return put_vlq(put(p, steppers_[m.target].reset_clock), uint32_t(m.clock + base_));
      case MessageKind::tail:
        p = put_vlq_any(put(p, steppers_[m.target].tail),
                        m.count > 0 ? m.interval : m.interval + uint32_t(base_));
        p = put_vlq_any(put_vlq(p, m.count), uint32_t(int32_t(m.add)));
        return put_vlq(p, uint32_t(m.dir != 0) ^ uint32_t(steppers_[m.target].invert));
      case MessageKind::commit:
        p = put_vlq(put_vlq(put(p, commit_), m.interval), uint32_t(m.clock + base_));
        return put_vlq(p, m.dir);
      case MessageKind::pin:
        break;  // it may be told something else
    }
    return p;
  }
  static uint8_t* put_value(uint8_t* p, const Pin& pin, Ticks clock, uint32_t value) {
    return put_vlq(put_vlq(put(p, pin.update), uint32_t(clock)), on_wire(value, pin.inverted_full));
  }
  // The pin whose kick ends first, not after that board clock; null if none.
  Pin* kicked_until(Ticks clock) {
    Pin* found = nullptr;
    for (Pin& pin : pins_)
      if (pin.kick.end() <= clock && (!found || pin.kick.end() < found->kick.end())) found = &pin;
    return found;
  }
  // The board needs moves by their first step, with what goes before them. What is staged needs its
  // commit by then too, and by the clock of the commit before, at which the board would brake.
  Ticks needed_at(const Message& m) {
    Ticks clock = m.clock + base_;
    switch (m.kind) {
      case MessageKind::pin:
        return clock;
      case MessageKind::queue_step:
        clock = m.start() + m.span(1) + base_;
        staged_ = std::min(staged_, clock);
        return clock;
      case MessageKind::commit:
        return std::exchange(staged_, m.dir ? kNever : clock);
      default:
        return kNever;
    }
  }
  // Forgets the slots that are free by now; false if there is none.
  bool free_slots(Ticks now) {
    Ticks passed = now - margin_, next = kNever;
    size_t kept = 0;
    for (Ticks end : ends_) {
      if (end <= passed) continue;
      ends_[kept++] = end;
      next = std::min(next, end);
    }
    ends_.resize(kept);
    if (kept < slots_) return true;
    slot_wait_ = next + margin_;
    return false;
  }
};

}  // namespace passo::wire
