// The messages of one board from the planner to the link, in the order in which they are sent.
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

// A ring buffer that grows. Only one thread at a time may use it. After share(), a thread must
// hold() it.
class MessageQueue {
 public:
  MessageQueue() : ring_(kSmallest) {}
  bool empty() const { return head_ == tail_; }
  size_t size() const { return tail_ - head_; }
  void push(const Message& message) {
    if (tail_ - kept_ > mask_) grow();
    ring_[tail_++ & mask_] = message;
  }
  // Inserts before all waiting messages. Allowed only if no messages are kept.
  void push_front(const Message& message);
  // Inserts after all messages whose clocks are not later.
  void insert(const Message& message);
  // Inserts the value of a pin like insert(). Replaces an earlier value of the pin at the same
  // clock, which would have no effect.
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
  // From now on keeps the messages of this number of commits, so that rewind() can go back to them.
  void keep(size_t commits);
  // The index of the first message after this commit, among the messages taken. Returns nothing if
  // the commit was not taken, or is no longer kept. kFirst: the first message since keep().
  static constexpr int64_t kFirst = -1;
  std::optional<size_t> behind(int64_t serial) const;
  // Messages from index `begin` on will be taken again. Those before it ended at `clock`.
  void rewind(size_t begin, int64_t clock);
  // Visits all kept and all waiting messages in their order.
  template <typename Visit>
  void visit(Visit&& visit) const {
    for (size_t i = kept_; i != tail_; ++i) visit(at(i));
  }
  // Latest end of all messages taken so far. They cannot be revoked any more.
  int64_t taken_until() const { return taken_until_; }
  // From now on a link's thread takes messages while other threads add and revoke them.
  void share() { guard_->shared = true; }
  // Locks the queue and all joined queues while the result exists, if they are shared.
  std::unique_lock<std::recursive_mutex> hold() {
    return guard_->shared ? std::unique_lock(guard_->mutex)
                          : std::unique_lock(guard_->mutex, std::defer_lock);
  }
  // From now on both queues have the same lock. Call this before either is used.
  void join(MessageQueue& other) { guard_ = other.guard_; }
  void clear() { tail_ = head_; }

 private:
  const Message& at(size_t i) const { return ring_[i & mask_]; }
  void grow();
  static constexpr size_t kSmallest = 256;  // fits into the first-level cache
  std::vector<Message> ring_;               // its size is a power of two
  size_t mask_ = kSmallest - 1;             // size minus one
  size_t kept_ = 0, head_ = 0, tail_ = 0;
  size_t first_ = 0;  // first message since keep()
  int64_t taken_until_ = 0;
  size_t keeps_ = 0, commits_ = 0;  // number of commits between kept_ and head_
  struct Guard {
    std::recursive_mutex mutex;  // recursive: a cut passes messages on while it holds the lock
    std::atomic<bool> shared{false};
  };
  std::shared_ptr<Guard> guard_ = std::make_shared<Guard>();
};

}  // namespace passo
