// The steps of all motors, and the changes of all outputs, as messages to each board in the order
// of their clocks; what no board has taken yet can be revoked.
#pragma once
#include <algorithm>
#include <cmath>
#include <deque>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "machine/machine.hpp"
#include "plan/statistics.hpp"
#include "steps/commits.hpp"
#include "steps/compressor.hpp"
#include "steps/message_queue.hpp"
#include "steps/step_recall.hpp"
#include "steps/step_solver.hpp"

namespace passo {

class StepStream {
 public:
  // The way on which the machine would stop from a clock on.
  using Brake = std::function<void(int64_t clock, std::vector<Move>& moves)>;

  // `with_steps` false: no motor makes a step.
  StepStream(const Machine& machine, bool with_steps, Brake brake)
      : machine_(machine), brake_(std::move(brake)) {
    for (size_t i = 0; with_steps && i < machine_.steppers.size(); ++i) {
      solvers_.emplace_back(machine_, machine_.steppers[i]);
      compressors_.emplace_back(machine_, machine_.steppers[i], uint16_t(i));
    }
    for (size_t i = 0; i < machine_.boards; ++i) {
      messages_.emplace_back();
      messages_[i].join(messages_[0]);
    }
    set_apart_.resize(solvers_.size());
  }
  StepStream(const StepStream&) = delete;
  StepStream& operator=(const StepStream&) = delete;

  // Of one board; all their clocks are those of the main one, 0.
  MessageQueue& messages(size_t board) { return messages_[board]; }
  // Messages that wait to be taken.
  size_t waiting() {
    auto held = hold();
    size_t all = 0;
    for (const MessageQueue& queue : messages_) all += queue.size();
    return all;
  }
  // Keeps what boards take, and have taken, as it is while the result lives.
  std::unique_lock<std::recursive_mutex> hold() { return messages_[0].hold(); }
  // Latest end of all messages taken so far.
  int64_t taken_until() const {
    int64_t latest = 0;
    for (const MessageQueue& queue : messages_) latest = std::max(latest, queue.taken_until());
    return latest;
  }
  int64_t handed_out() const { return handed_out_; }  // clock of the last of all messages so far

  const StepStatistics& statistics(size_t i) const { return compressors_[i].statistics(); }
  Compressor& compressor(size_t i) { return compressors_[i]; }
  size_t motors() const { return solvers_.size(); }
  int64_t count(size_t i) const { return solvers_[i].count(); }
  // Net steps that motor i was to make: its rounded targets, less what positions were set without
  // motion.
  int64_t expected_net(size_t i) const { return solvers_[i].count() - set_apart_[i]; }
  // Sets where motor i is, in steps, without motion.
  void set_count(size_t i, int64_t count) {
    set_apart_[i] += count - solvers_[i].count();
    solvers_[i].set_count(count);
  }
  void set_position(size_t i, const double* position) {
    set_count(i, solvers_[i].count_at(position));
  }
  // The next step of motor i tells its clock and direction anew. Only at rest.
  void renew(size_t i) { compressors_[i].renew(); }
  void renew() {
    for (Compressor& c : compressors_) c.renew();
  }

  void solve(const Piece& piece) {
    for (size_t i = 0; i < solvers_.size(); ++i) solvers_[i].solve(piece, compressors_[i].steps());
  }
  void solve(const std::vector<Move>& moves) {
    for (size_t i = 0; i < solvers_.size(); ++i)
      for (const Move& m : moves) solvers_[i].solve(m, compressors_[i].steps());
  }
  // Makes commands of steps: no further one comes before `clock`; `still`: none is under way there.
  void compress(double clock, bool still) {
    // What follows a commit lies behind it, also where its first steps may be a little early.
    const int64_t behind = commits_ ? commits_->points().back().clock : kAnyClock;
    for (Compressor& c : compressors_) c.advance(clock, still, behind);
  }
  // An output's value, from `ticks` on. Returns its clock, which is not before what is handed out.
  int64_t set_output(uint16_t target, uint32_t value, double ticks) {
    int64_t clock = not_before(ticks);
    outputs_.set_pin({clock, clock, value, 0, 0, target, MessageKind::pin, 0});
    return clock;
  }
  int64_t not_before(double ticks) const {
    return std::max(int64_t(std::floor(ticks + 0.5)), handed_out_);
  }
  // The same in the midst of what is handed out, at a clock that no board has taken yet.
  void set_output_among(uint16_t target, uint32_t value, double ticks) {
    int64_t clock = std::max(int64_t(std::ceil(ticks)), taken_until());
    Message m{clock, clock, value, 0, 0, target, MessageKind::pin, 0};
    bool committed = !commits_ || clock <= commits_->points().back().clock;
    MessageQueue& queue = clock >= handed_out_ ? outputs_
                          : committed          ? queue_of(m)
                                               : commits_->waiting();
    queue.insert(m);
  }

  // Hands out, each to its board, all that nothing can precede when all moves up to `clock` are
  // known; `all`: everything.
  void merge(double clock, bool all) {
    auto held = hold();
    double limit = clock;
    for (Compressor& c : compressors_) limit = std::min(limit, c.next_clock(clock));
    // Which comes next is as good as random: the comparisons must not be branches.
    std::vector<MessageQueue*>& queues = merged_;
    queues.assign(1, &outputs_);
    for (Compressor& c : compressors_) queues.push_back(&c.messages());
    next_clocks_.clear();
    for (MessageQueue* queue : queues) next_clocks_.push_back(queue->next_clock());
    const int64_t end = all ? kNoMessage : int64_t(std::ceil(limit));
    // Where all go; null if it is a matter of the message.
    MessageQueue* common = commits_                ? &commits_->waiting()
                           : messages_.size() == 1 ? &messages_[0]
                                                   : nullptr;
    for (;;) {
      int64_t first_clock = next_clocks_[0];
      size_t first = 0;
      for (size_t i = 1; i < queues.size(); ++i) {
        bool sooner = next_clocks_[i] < first_clock;
        first_clock = sooner ? next_clocks_[i] : first_clock;
        first = sooner ? i : first;
      }
      if (first_clock >= end) break;
      const Message& next = queues[first]->front();
      (common ? *common : queue_of(next)).push(next);
      handed_out_ = std::max(handed_out_, next.clock);
      queues[first]->pop();
      next_clocks_[first] = queues[first]->next_clock();
    }
    if (!all) commit(end, kNoMessage);
    if (all)
      for (Compressor& c : compressors_) c.not_before(handed_out_);
  }
  // After all is merged: the machine stands at `clock`.
  void stand(double clock) { commit(kNoMessage, int64_t(std::ceil(clock))); }

  // Keeps what is executed up to `at`, which no board has taken yet, and sets every motor back to
  // its last step kept. Steps known so far become commands first, all before `clock`: those that
  // wait for more of their kind may be due before `at`.
  void revoke(int64_t at, double clock) {
    compress(clock, true);
    merge(clock, true);
    size_t n = compressors_.size();
    Revocation revoked(n);
    for (size_t i = 0; i < n; ++i) revoked.last[i] = compressors_[i].last();
    if (commits_)
      for (MessageQueue& all = commits_->waiting(); !all.empty(); all.pop())
        queue_of(all.front()).push(all.front());
    std::vector<Message> open;
    for (MessageQueue& queue : messages_) revoke(queue, at, revoked, open);
    if (commits_) {
      commits_->revoke(at);
      std::stable_sort(open.begin(), open.end(), sooner);
      commits_->put_back(open);
    }
    outputs_.clear();
    handed_out_ = at;
    for (size_t i = 0; i < n; ++i) {
      const StepStatistics& lost = revoked.lost[i];
      solvers_[i].set_count(solvers_[i].count() - compressors_[i].pending_net() - lost.net);
      compressors_[i].restart(revoked.last[i], lost);
      compressors_[i].not_before(at);
    }
    if (commits_) commits_->resume(std::move(revoked.last), nets(), renews());
  }
  // Nothing before `past` will be revoked or asked for any more.
  void forget(int64_t past) {
    for (Compressor& c : compressors_) c.forget_resets(past);
  }

  // From now on messages come in commits (commits.hpp): each of at most `period` ticks and `most`
  // messages. Only while the machine stands, from `clock` on, and nothing is waiting. The last
  // kKeptCommits that were taken are kept for rewind().
  void use_commits(int64_t period, size_t most, int64_t clock) {
    commits_.emplace(machine_, period, most);
    begin_commits(0, clock);
  }
  void stop_commits() { commits_.reset(); }
  bool commits() const { return commits_.has_value(); }
  // The earliest clock that rewind() can go back to; only with commits.
  int64_t oldest_commit() const { return commits_->points().front().clock; }
  // Goes back behind the commit `serial`: what came later has not been executed, and waits again.
  // Returns it; nothing, and nothing is changed, if that is not known any more.
  std::optional<Commits::Point> rewind(uint32_t serial) {
    if (!commits_) return std::nullopt;
    auto p = commits_->find(serial);
    if (p == commits_->points().end()) return std::nullopt;
    std::vector<size_t> begins;
    for (const MessageQueue& queue : messages_)
      if (std::optional<size_t> begin = queue.behind(last_of(*p))) begins.push_back(*begin);
    if (begins.size() < messages_.size()) return std::nullopt;  // of one, but not of all
    for (size_t i = 0; i < begins.size(); ++i) messages_[i].rewind(begins[i], p->clock);
    return *p;
  }
  // Net steps by which each motor is further where it stands behind the commit `next`, whose brake
  // tails are done, than behind the one before that, `serial`. Nothing if they do not follow each
  // other, or are not known any more.
  std::optional<std::vector<int64_t>> between_stops(uint32_t serial, uint32_t next) {
    auto held = hold();
    if (!commits_) return std::nullopt;
    auto p = commits_->find(serial);
    if (p == commits_->points().end() || ++p == commits_->points().end() || p->serial != next)
      return std::nullopt;
    std::vector<int64_t> net(solvers_.size(), 0);
    for (const MessageQueue& queue : messages_) {
      if (!queue.behind(last_of(*std::prev(p)))) return std::nullopt;
      bool behind = commits_->begins_with(*std::prev(p)), over = false;
      std::vector<std::pair<size_t, int64_t>> tails;
      queue.visit([&](const Message& m) {
        int64_t steps = m.dir ? m.count : -int64_t(m.count);
        if (m.kind == MessageKind::commit) {
          over |= m.interval == next;
          for (auto [motor, tail] : tails)
            net[motor] += m.interval == next ? tail : m.interval == serial ? -tail : 0;
          tails.clear();
          behind |= m.interval == serial;
        } else if (m.kind == MessageKind::tail) {
          tails.emplace_back(m.target, steps);
        } else if (m.kind == MessageKind::queue_step && behind && !over) {
          net[m.target] += steps;
        }
      });
    }
    return net;
  }
  // After rewind() and a plan to a stop, which the boards have come to by themselves: takes back
  // what that has handed out, and returns the outputs among it. The machine stands at `clock`.
  std::vector<Message> resume_at_rest(uint32_t serial, int64_t clock) {
    std::vector<Message> outputs;
    for (MessageQueue& queue : messages_)
      for (; !queue.empty(); queue.pop())
        if (queue.front().kind == MessageKind::pin) outputs.push_back(queue.front());
    std::stable_sort(outputs.begin(), outputs.end(), sooner);
    renew();
    begin_commits(serial, clock);
    return outputs;
  }

 private:
  static constexpr size_t kKeptCommits = 128;  // more than the frames on their way can hold
  const Machine& machine_;
  Brake brake_;
  std::vector<StepSolver> solvers_;
  std::vector<int64_t> set_apart_;  // steps by which positions were set without motion
  std::deque<Compressor> compressors_;
  std::deque<MessageQueue> messages_;  // by board
  MessageQueue outputs_;
  std::optional<Commits> commits_;
  std::vector<MessageQueue*> merged_;  // outputs_ and those of the compressors
  std::vector<int64_t> next_clocks_;   // of each of them
  int64_t handed_out_ = 0;

  // The queue of the board that is to have a message.
  MessageQueue& queue_of(const Message& m) {
    if (m.kind != MessageKind::pin) return messages_[machine_.steppers[m.target].board];
    const std::vector<uint16_t>& boards = machine_.output_boards;
    return messages_[m.target < boards.size() ? boards[m.target] : 0];
  }
  std::vector<int64_t> nets() const {
    std::vector<int64_t> net;
    for (size_t i = 0; i < solvers_.size(); ++i) net.push_back(expected_net(i));
    return net;
  }
  std::vector<bool> renews() const {
    std::vector<bool> renews;
    for (const Compressor& c : compressors_) renews.push_back(c.renews());
    return renews;
  }
  // The board's last commit is `serial`, and the machine stands.
  void begin_commits(uint32_t serial, int64_t clock) {
    auto held = hold();
    for (MessageQueue& queue : messages_) queue.keep(kKeptCommits);
    std::vector<int64_t> last;
    for (const Compressor& c : compressors_) last.push_back(c.last());
    commits_->begin(serial, clock, std::move(last), nets(), renews());
  }
  // Hands out what is certain; `stands` where the machine stands, or kNoMessage.
  void commit(int64_t known, int64_t stands) {
    if (!commits_) return;
    auto held = hold();
    commits_->advance(known, stands, set_apart_, brake_, [this](const Message& m) {
      if (m.kind != MessageKind::commit) return queue_of(m).push(m);
      for (MessageQueue& queue : messages_) queue.push(m);
    });
    int64_t taken = kNoMessage;  // by all
    for (const MessageQueue& queue : messages_) taken = std::min(taken, queue.taken_until());
    commits_->forget(taken, kKeptCommits);
  }
  // What MessageQueue::behind() calls it.
  int64_t last_of(const Commits::Point& p) const {
    return commits_->begins_with(p) ? MessageQueue::kFirst : int64_t(p.serial);
  }
  static bool sooner(const Message& a, const Message& b) { return a.clock < b.clock; }
  // What is kept, but in no commit, comes to `open`.
  void revoke(MessageQueue& queue, int64_t at, Revocation& revoked, std::vector<Message>& open) {
    std::vector<Message> kept = revoked.keep(queue, at, [&](const Message& reset) {
      return compressors_[reset.target].before_reset(reset.clock);
    });
    if (commits_) {
      auto behind = std::find_if(kept.rbegin(), kept.rend(), [](const Message& m) {
                      return m.kind == MessageKind::commit;
                    }).base();
      open.insert(open.end(), behind, kept.end());
      kept.erase(behind, kept.end());
    }
    for (const Message& m : kept) queue.push(m);
  }
};

}  // namespace passo
