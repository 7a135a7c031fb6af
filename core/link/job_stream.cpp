#include "link/job_stream.hpp"

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <utility>

#include "link/retimer.hpp"

namespace passo::wire {

JobStream::JobStream(double clock_hz)
    : horizon_(Ticks(kHorizonSeconds * clock_hz)), quantum_(Ticks(kQuantumSeconds * clock_hz)),
      margin_(Ticks(kMarginSeconds * clock_hz)) {}

JobStream::~JobStream() = default;

void JobStream::add_stepper(const Formats& commands, size_t target, const std::string& name,
                            uint32_t oid, bool invert) {
  if (steppers_.size() <= target) steppers_.resize(target + 1);
  steppers_[target] = {prefix(commands, "queue_step", oid),
                       prefix(commands, "set_next_step_dir", oid),
                       prefix(commands, "reset_step_clock", oid),
                       {},
                       oid,
                       StreamHash::of_name(name),
                       invert};
}

void JobStream::use_commits(const Formats& commands, Ticks horizon) {
  commit_ = prefix(commands, "survive_commit");
  query_ = prefix(commands, "survive_query");
  for (Stepper& s : steppers_) s.tail = prefix(commands, "survive_tail", s.oid);
  horizon_ = horizon;
  commits_ = true;
}

Retimer& JobStream::retime(double tolerance) {
  if (!retimer_) retimer_ = std::make_unique<Retimer>(tolerance);
  return *retimer_;
}

void JobStream::add_pin(const Formats& commands, size_t target, const std::string& name,
                        uint32_t oid, PinKind kind, uint32_t inverted_full, Ticks longest) {
  if (pins_.size() <= target) pins_.resize(target + 1);
  pins_[target] = {
      prefix(commands, kind == PinKind::pwm ? "queue_pwm_out" : "queue_digital_out", oid),
      StreamHash::of_name(name), inverted_full, longest};
  renews_ = renews_ || longest > 0;
}

void JobStream::set_kick(size_t target, Kick kick) {
  pins_.at(target).kick = kick;
  kicks_ = kicks_ || kick;
}

Ticks JobStream::renew_at() const {
  Ticks next = kNever;
  if (!renews_ || !running_) return next;
  for (const Pin& pin : pins_)
    if (pin.longest > 0 && pin.value > 0) next = std::min(next, pin.sent_at + pin.longest / 2);
  return next;
}

Bytes JobStream::renew(Ticks now) {
  Bytes payload;
  if (renew_at() > now) return payload;
  for (Pin& pin : pins_) {
    if (pin.longest == 0 || pin.value == 0 || now < pin.sent_at + pin.longest / 2) continue;
    pin.sent_at = std::max(pin.sent_at + 1, now + 2 * quantum_);
    uint8_t buffer[kMaxCommandBytes];
    payload.assign(buffer, put_value(buffer, pin, pin.sent_at, pin.value));
    break;
  }
  return payload;
}

uint32_t JobStream::on_wire(uint32_t value, uint32_t inverted_full) {
  return inverted_full ? inverted_full - std::min(value, inverted_full) : value;
}

void JobStream::set_slots(size_t slots) {
  slots_ = slots;
  ends_.reserve(slots);
}

void JobStream::start(Ticks base) {
  base_ = base;
  hash_ = StreamHash();
  queue_steps_ = messages_ = 0;
  staged_ = kNever;
  for (Pin& pin : pins_) {
    pin.kick.forget();
    pin.sent_at = 0;  // the board may have restarted
  }
  running_ = true;
}

void JobStream::resume() {
  ends_.clear();
  staged_ = kNever;
  complete_ = false;
  if (retimer_) retimer_->restart();
  for (Pin& pin : pins_)
    if (pin.kick.interrupt() || pin.longest > 0) pin.value = 0;  // the board has switched it off
  running_ = true;
}

std::vector<Bytes> JobStream::resets(Ticks clock) const {
  std::vector<Bytes> all;
  for (const Stepper& stepper : steppers_) {
    if (stepper.reset_clock.size == 0) continue;
    uint8_t buffer[kMaxCommandBytes];
    uint8_t* p = put_vlq(put(buffer, stepper.reset_clock), uint32_t(clock));
    all.emplace_back(buffer, p);
  }
  return all;
}

JobStream::Fill JobStream::fill(uint8_t* payload, size_t& size, Ticks& first, Ticks& need,
                                Ticks now, const Ask& commit) {
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
      Ticks clock = std::max({pin->kick.end(), pin->sent_at + 1, now + 2 * quantum_});
      uint8_t* end = put_value(payload + size, *pin, clock, pin->kick.asked());
      if (size_t(end - payload) > kPayloadMax) return Fill::full;
      size = size_t(end - payload);
      first = std::min(first, clock);
      need = std::min(need, clock);
      ends_.push_back(clock);
      pin->sent(clock, pin->kick.asked());
      pin->kick.over();
      continue;
    }
    if (next > limit) break;
    const Message& m = queue.front();
    const bool commits = m.kind == MessageKind::commit;
    if (commits && size + kMaxCommitBytes > kPayloadMax) return Fill::full;
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
      // The end of a kickstart, and renewed values, have clocks of their own.
      const Ticks clock = std::max(m.clock + base_, pin.sent_at);
      Kick kick = pin.kick;
      uint32_t value = kick.value_at(m.interval, pin.value, clock);
      end = put_value(payload + size, pin, clock, value);
      if (size_t(end - payload) > kPayloadMax) return Fill::full;
      pin.kick = kick;
      pin.sent(clock, value);
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

Ticks JobStream::wake() const {
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

JobStream::Prefix JobStream::prefix(const Formats& commands, const std::string& name,
                                    uint32_t oid) {
  Prefix prefix{};
  uint8_t buffer[2 * kVlqMax];
  uint8_t* end = put_vlq(put_vlq(buffer, uint32_t(commands.at(name).id)), oid);
  prefix.size = uint8_t(end - buffer);
  if (prefix.size > 4) throw std::invalid_argument("oid out of range: " + std::to_string(oid));
  std::copy(buffer, end, prefix.bytes);
  return prefix;
}

// The next functions run once for each message: `inline` allows fill() to contain them.

inline void JobStream::count(const Message& m) {
  if (m.kind == MessageKind::tail || m.kind == MessageKind::commit) return;
  ++messages_;
  hash_.add(m, m.kind == MessageKind::pin ? pins_[m.target].name : steppers_[m.target].name);
}

inline void JobStream::retime(Ticks limit) {
  if (!retimer_->ready().empty() || queue_->empty()) return;
  if (retimer_->clock_of(due(queue_->front())) > limit) return;
  count(queue_->front());
  retimer_->retime(queue_->front());
  queue_->pop();
}

JobStream::Prefix JobStream::prefix(const Formats& commands, const std::string& name) {
  Prefix prefix{};
  prefix.size = uint8_t(put_vlq(prefix.bytes, uint32_t(commands.at(name).id)) - prefix.bytes);
  return prefix;
}

inline uint8_t* JobStream::put(uint8_t* p, const Prefix& prefix) {
  std::memcpy(p, prefix.bytes, 4);
  return p + prefix.size;
}

inline uint8_t* JobStream::encode(const Message& m, uint8_t* p) const {
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
      break;  // another command may follow
  }
  return p;
}

inline uint8_t* JobStream::put_value(uint8_t* p, const Pin& pin, Ticks clock, uint32_t value) {
  return put_vlq(put_vlq(put(p, pin.update), uint32_t(clock)), on_wire(value, pin.inverted_full));
}

inline JobStream::Pin* JobStream::kicked_until(Ticks clock) {
  Pin* found = nullptr;
  for (Pin& pin : pins_)
    if (pin.kick.end() <= clock && (!found || pin.kick.end() < found->kick.end())) found = &pin;
  return found;
}

inline Ticks JobStream::needed_at(const Message& m) {
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

inline bool JobStream::free_slots(Ticks now) {
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

}  // namespace passo::wire
