#include "steps/step_stream.hpp"

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <utility>

#include "steps/step_recall.hpp"

namespace passo {

StepStream::StepStream(const Machine& machine, bool with_steps, Brake brake)
    : machine_(machine), brake_(std::move(brake)), nozzle_(machine) {
  for (size_t i = 0; with_steps && i < machine_.steppers.size(); ++i) {
    solvers_.emplace_back(machine_, machine_.steppers[i]);
    filtered_.emplace_back(machine_, machine_.steppers[i], nozzle_);
    compressors_.emplace_back(machine_, machine_.steppers[i], uint16_t(i));
  }
  for (size_t i = 0; i < machine_.boards; ++i) {
    messages_.emplace_back();
    messages_[i].join(messages_[0]);
  }
  set_apart_.resize(solvers_.size());
  rests_.resize(solvers_.size());
}

size_t StepStream::waiting() {
  auto held = hold();
  size_t all = 0;
  for (const MessageQueue& queue : messages_) all += queue.size();
  return all;
}

int64_t StepStream::taken_until() const {
  int64_t latest = 0;
  for (const MessageQueue& queue : messages_) latest = std::max(latest, queue.taken_until());
  return latest;
}

void StepStream::set_count(size_t i, int64_t count) {
  set_apart_[i] += count - solvers_[i].count();
  solvers_[i].set_count(count);
}

void StepStream::set_position(size_t i, const double* position) {
  set_count(i, solvers_[i].count_at(position));
}

void StepStream::use_gaps() {
  for (size_t i = 0; i < solvers_.size(); ++i) {
    filtered_[i].use_gap();
    const int64_t before = solvers_[i].lead();
    solvers_[i].set_lead(filtered_[i].lead());
    set_count(i, solvers_[i].count() + solvers_[i].lead() - before);
  }
}

void StepStream::lean(size_t i) {
  filtered_[i].lean(compressors_[i].direction());
  solvers_[i].set_lead(filtered_[i].lead());
}

void StepStream::renew() {
  for (Compressor& c : compressors_) c.renew();
}

void StepStream::solve(const Piece& piece) {
  for (size_t i = 0; i < solvers_.size(); ++i) solvers_[i].solve(piece, compressors_[i].steps());
}

void StepStream::solve(const std::vector<Move>& moves, double known, bool last) {
  if (machine_.filters.on()) {
    if (nozzle_.needed()) nozzle_.solve(moves, known, last);
    for (size_t i = 0; i < solvers_.size(); ++i)
      if (!rests_[i]) filtered_[i].solve(moves, known, last, solvers_[i], compressors_[i].steps());
    return;
  }
  for (size_t i = 0; i < solvers_.size(); ++i)
    if (!rests_[i])
      for (const Move& m : moves) solvers_[i].solve(m, compressors_[i].steps());
}

void StepStream::restart_filters(double clock, const std::vector<Move>& past) {
  if (nozzle_.needed()) nozzle_.restart(clock, past);
  for (size_t i = 0; i < solvers_.size(); ++i)
    if (!rests_[i]) filtered_[i].restart(clock, past, solvers_[i]);
}

void StepStream::compress(double clock, bool still) {
  // Messages after a commit must be later than it, also if their steps are a little early.
  const int64_t behind = commits_ ? commits_->points().back().clock : kAnyClock;
  for (Compressor& c : compressors_) c.advance(clock, still, behind);
}

int64_t StepStream::set_output(uint16_t target, uint32_t value, double ticks) {
  int64_t clock = not_before(ticks);
  outputs_.set_pin({clock, clock, value, 0, 0, target, MessageKind::pin, 0});
  return clock;
}

int64_t StepStream::not_before(double ticks) const {
  return std::max(int64_t(std::floor(ticks + 0.5)), handed_out_);
}

void StepStream::set_output_among(uint16_t target, uint32_t value, double ticks) {
  int64_t clock = std::max(int64_t(std::ceil(ticks)), taken_until());
  Message m{clock, clock, value, 0, 0, target, MessageKind::pin, 0};
  bool committed = !commits_ || clock <= commits_->points().back().clock;
  MessageQueue& queue = clock >= handed_out_ ? outputs_
                        : committed          ? queue_of(m)
                                             : commits_->waiting();
  queue.insert(m);
}

void StepStream::merge(double clock, bool all) {
  auto held = hold();
  double limit = clock;
  for (Compressor& c : compressors_) limit = std::min(limit, c.next_clock(clock));
  // The next queue is hard to predict, so the comparisons must not become branches.
  std::vector<MessageQueue*>& queues = merged_;
  queues.assign(1, &outputs_);
  for (Compressor& c : compressors_) queues.push_back(&c.messages());
  next_clocks_.clear();
  for (MessageQueue* queue : queues) next_clocks_.push_back(queue->next_clock());
  const int64_t end = all ? kNoMessage : int64_t(std::ceil(limit));
  // The queue for all messages; null if it depends on the message.
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

void StepStream::revoke(int64_t at, double clock) {
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

void StepStream::forget(int64_t past) {
  for (Compressor& c : compressors_) c.forget_resets(past);
  for (FilteredSolver& filtered : filtered_) filtered.forget(double(past));
}

void StepStream::use_commits(int64_t period, size_t most, int64_t clock) {
  commits_.emplace(machine_, period, most, solvers_, filtered_);
  begin_commits(0, clock);
}

std::optional<Commits::Point> StepStream::rewind(uint32_t serial) {
  if (!commits_) return std::nullopt;
  auto p = commits_->find(serial);
  if (p == commits_->points().end()) return std::nullopt;
  std::vector<size_t> begins;
  for (const MessageQueue& queue : messages_)
    if (std::optional<size_t> begin = queue.behind(last_of(*p))) begins.push_back(*begin);
  if (begins.size() < messages_.size())
    return std::nullopt;  // some boards know the commit, but not all
  for (size_t i = 0; i < begins.size(); ++i) messages_[i].rewind(begins[i], p->clock);
  return *p;
}

std::optional<std::vector<int64_t>> StepStream::between_stops(uint32_t serial, uint32_t next) {
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

std::vector<Message> StepStream::resume_at_rest(uint32_t serial, int64_t clock) {
  std::vector<Message> outputs;
  for (MessageQueue& queue : messages_)
    for (; !queue.empty(); queue.pop())
      if (queue.front().kind == MessageKind::pin) outputs.push_back(queue.front());
  std::stable_sort(outputs.begin(), outputs.end(), sooner);
  renew();
  begin_commits(serial, clock);
  return outputs;
}

MessageQueue& StepStream::queue_of(const Message& m) {
  if (m.kind != MessageKind::pin) return messages_[machine_.steppers[m.target].board];
  const std::vector<uint16_t>& boards = machine_.output_boards;
  return messages_[m.target < boards.size() ? boards[m.target] : 0];
}

std::vector<int64_t> StepStream::nets() const {
  std::vector<int64_t> net;
  for (size_t i = 0; i < solvers_.size(); ++i) net.push_back(expected_net(i));
  return net;
}

std::vector<bool> StepStream::renews() const {
  std::vector<bool> renews;
  for (const Compressor& c : compressors_) renews.push_back(c.renews());
  return renews;
}

void StepStream::begin_commits(uint32_t serial, int64_t clock) {
  auto held = hold();
  for (MessageQueue& queue : messages_) queue.keep(kKeptCommits);
  std::vector<int64_t> last;
  for (const Compressor& c : compressors_) last.push_back(c.last());
  commits_->begin(serial, clock, std::move(last), nets(), renews());
}

void StepStream::commit(int64_t known, int64_t stands) {
  if (!commits_) return;
  auto held = hold();
  commits_->advance(known, stands, set_apart_, brake_, [this](const Message& m) {
    if (m.kind != MessageKind::commit) return queue_of(m).push(m);
    for (MessageQueue& queue : messages_) queue.push(m);
  });
  int64_t taken = kNoMessage;  // by all boards
  for (const MessageQueue& queue : messages_) taken = std::min(taken, queue.taken_until());
  commits_->forget(taken, kKeptCommits);
}

int64_t StepStream::last_of(const Commits::Point& p) const {
  return commits_->begins_with(p) ? MessageQueue::kFirst : int64_t(p.serial);
}

void StepStream::revoke(MessageQueue& queue, int64_t at, Revocation& revoked,
                        std::vector<Message>& open) {
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

}  // namespace passo
