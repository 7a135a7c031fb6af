#include "steps/message_queue.hpp"

#include <utility>

namespace passo {

void MessageQueue::push_front(const Message& message) {
  if (tail_ - kept_ > mask_) grow();
  kept_ = --head_;
  ring_[head_ & mask_] = message;
}

void MessageQueue::insert(const Message& message) {
  push(message);
  for (size_t i = tail_ - 1; i != head_; --i) {
    Message &before = ring_[(i - 1) & mask_], &here = ring_[i & mask_];
    if (before.clock <= here.clock) break;
    std::swap(before, here);
  }
}

void MessageQueue::set_pin(const Message& message) {
  for (size_t i = tail_; i != head_ && at(i - 1).clock >= message.clock; --i) {
    Message& there = ring_[(i - 1) & mask_];
    if (there.clock > message.clock || there.kind != MessageKind::pin ||
        there.target != message.target)
      continue;
    there.interval = message.interval;
    return;
  }
  insert(message);
}

void MessageQueue::keep(size_t commits) {
  keeps_ = commits;
  commits_ = 0;
  kept_ = first_ = head_;
}

std::optional<size_t> MessageQueue::behind(int64_t serial) const {
  if (serial == kFirst) return kept_ == first_ ? std::optional(first_) : std::nullopt;
  for (size_t i = head_; i-- > kept_;)
    if (at(i).kind == MessageKind::commit && at(i).interval == serial) return i + 1;
  return std::nullopt;
}

void MessageQueue::rewind(size_t begin, int64_t clock) {
  for (size_t i = begin; i < head_; ++i) commits_ -= at(i).kind == MessageKind::commit;
  head_ = begin;
  taken_until_ = clock;
}

void MessageQueue::grow() {
  std::vector<Message> bigger(ring_.size() * 2);
  const size_t mask = bigger.size() - 1;
  for (size_t i = kept_; i != tail_; ++i) bigger[i & mask] = at(i);
  ring_.swap(bigger);
  mask_ = mask;
}

}  // namespace passo
