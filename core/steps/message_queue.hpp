// Messages of one board between the planner's side and the link, in the order in which they leave.
#pragma once
#include <algorithm>
#include <atomic>
#include <cstdint>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "base/types.hpp"

namespace passo {

inline constexpr int64_t kNoMessage = std::numeric_limits<int64_t>::max();

// A ring that grows. One thread at a time may use it; once it is shared, the thread that holds it.
class MessageQueue {
 public:
  MessageQueue() : ring_(kSmallest) {}
  bool empty() const { return head_ == tail_; }
  size_t size() const { return tail_ - head_; }
  void push(const Message& message) {
    if (tail_ - kept_ > mask_) grow();
    ring_[tail_++ & mask_] = message;
  }
  // Inserts before all waiting messages. Only if no messages are kept.
  void push_front(const Message& message);
  // Inserts after all messages whose clocks are not later.
  void insert(const Message& message);
  // A pin's value, as insert(); another value of it at the same clock would never be seen.
  void set_pin(const Message& message);
  const Message& operator[](size_t i) const { return at(head_ + i); }
  const Message& front() const { return (*this)[0]; }
  int64_t next_clock() const { return empty() ? kNoMessage : front().clock; }
  void pop() {
    taken_until_ = std::max(taken_until_, front().end_clock);
    ++head_;
    if (keeps_ == 0) {
      kept_ = head_;
    } else if (at(head_ - 1).kind == MessageKind::commit && ++commits_ > keeps_) {
      while (at(kept_++).kind != MessageKind::commit) continue;
      --commits_;
    }
  }
  // From here on keeps the messages of this number of commits, for rewind().
  void keep(size_t commits);
  // The index of the first message after this commit, among the messages taken. Nothing if the
  // commit was taken too long ago, or not at all. kFirst: the first message since keep().
  static constexpr int64_t kFirst = -1;
  std::optional<size_t> behind(int64_t serial) const;
  // All messages from that index on will be taken again. The messages taken before ended at
  // `clock`.
  void rewind(size_t begin, int64_t clock);
  // All kept and all waiting messages, in their order.
  template <typename Visit>
  void visit(Visit&& visit) const {
    for (size_t i = kept_; i != tail_; ++i) visit(at(i));
  }
  // Latest end of all messages taken so far: they can no longer be revoked.
  int64_t taken_until() const { return taken_until_; }
  // From now on a link's thread takes messages while others add and revoke them.
  void share() { guard_->shared = true; }
  // If the queue is shared, locks it and all joined queues for the caller, while the result exists.
  std::unique_lock<std::recursive_mutex> hold() {
    return guard_->shared ? std::unique_lock(guard_->mutex)
                          : std::unique_lock(guard_->mutex, std::defer_lock);
  }
  // From now on one lock covers both queues. Call it before either is used.
  void join(MessageQueue& other) { guard_ = other.guard_; }
  void clear() { tail_ = head_; }

 private:
  const Message& at(size_t i) const { return ring_[i & mask_]; }
  void grow();
  static constexpr size_t kSmallest = 256;  // fits into the first-level cache
  std::vector<Message> ring_;               // its size is a power of two
  size_t mask_ = kSmallest - 1;             // size less one
  size_t kept_ = 0, head_ = 0, tail_ = 0;
  size_t first_ = 0;  // of the messages after keep()
  int64_t taken_until_ = 0;
  size_t keeps_ = 0, commits_ = 0;  // commits from kept_ to head_
  struct Guard {
    std::recursive_mutex mutex;  // recursive: cutting a plan passes messages on while it holds the
                                 // lock
    std::atomic<bool> shared{false};
  };
  std::shared_ptr<Guard> guard_ = std::make_shared<Guard>();
};

}  // namespace passo
