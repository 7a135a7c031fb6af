#include "steps/commits.hpp"

#include <utility>

namespace passo {

Commits::Commits(const Machine& machine, int64_t period, size_t most,
                 const std::vector<StepSolver>& original,
                 const std::deque<FilteredSolver>& filtered)
    : period_(period), most_(std::max<size_t>(most, 1)),
      widest_(std::max(kTailTolerance * machine.clock_hz, machine.widest_tolerance())),
      machine_(machine), original_(original), nozzle_(machine) {
  for (size_t i = 0; i < machine.steppers.size(); ++i) {
    solvers_.emplace_back(machine, machine.steppers[i]);
    filtered_.emplace_back(machine, machine.steppers[i], nozzle_, &filtered[i]);
    compressors_.emplace_back(machine, machine.steppers[i], uint16_t(i));
  }
}

void Commits::begin(uint32_t serial, int64_t clock, std::vector<int64_t> last,
                    std::vector<int64_t> net, std::vector<bool> renew) {
  last_ = std::move(last);
  net_ = std::move(net);
  renew_ = std::move(renew);
  begin_ = serial;
  points_.assign(1, {serial, clock, true, 0});
}

std::deque<Commits::Point>::const_iterator Commits::find(uint32_t serial) const {
  return std::find_if(points_.begin(), points_.end(),
                      [&](const Point& p) { return p.serial == serial; });
}

void Commits::revoke(int64_t clock) {
  while (points_.size() > 1 && points_.back().clock > clock) points_.pop_back();
}

void Commits::resume(std::vector<int64_t> last, std::vector<int64_t> net, std::vector<bool> renew) {
  renew_ = std::move(renew);
  last_ = std::move(last);
  net_ = std::move(net);
  std::vector<bool> waits(last_.size(), false);
  for (size_t i = 0; i < waiting_.size(); ++i) {
    const Message& m = waiting_[i];
    if (m.kind == MessageKind::reset_clock) renew_[m.target] = true;
    if (m.kind != MessageKind::queue_step) continue;
    if (!waits[m.target]) last_[m.target] = m.start();
    waits[m.target] = true;
    net_[m.target] -= m.dir ? m.count : -int64_t(m.count);
  }
}

void Commits::put_back(const std::vector<Message>& messages) {
  for (auto m = messages.rbegin(); m != messages.rend(); ++m) waiting_.push_front(*m);
}

void Commits::forget(int64_t taken_until, size_t kept) {
  while (points_.size() > kept && points_[kept].clock <= taken_until) points_.pop_front();
}

int64_t Commits::next_clock() const {
  for (size_t i = 0; i < waiting_.size(); ++i)
    if (waiting_[i].kind != MessageKind::pin) return waiting_[i].clock;
  return kNoMessage;
}

int64_t Commits::last_end() const {
  int64_t end = 0;
  for (size_t i = 0; i < waiting_.size(); ++i) end = std::max(end, waiting_[i].end_clock);
  return end;
}

void Commits::divide(int64_t clock) {
  within_.clear();
  behind_.clear();
  ahead_.resize(solvers_.size());
  for (; !waiting_.empty() && waiting_.front().clock <= clock; waiting_.pop()) {
    Message m = waiting_.front();
    if (m.kind == MessageKind::pin) {
      within_.push_back(m);
      continue;
    }
    std::vector<Message>& ahead = ahead_[m.target];
    if (m.kind != MessageKind::queue_step) {
      ahead.push_back(m);
      continue;
    }
    const int64_t start = m.start(), done = m.steps_until(clock);
    if (done > 0) {
      Message first = m;
      first.count = uint16_t(done);
      first.end_clock = start + m.span(done);
      for (Message& a : ahead) {
        if (a.kind == MessageKind::reset_clock) renew_[m.target] = false;
        a.end_clock = first.end_clock;  // it is sent with the steps after it
        within_.push_back(a);
      }
      ahead.clear();
      within_.push_back(first);
      last_[m.target] = first.end_clock;
      net_[m.target] += m.dir ? done : -done;
      m.clock = first.end_clock;
      m.interval = uint32_t(int64_t(m.interval) + m.add * done);
      m.count = uint16_t(m.count - done);
    }
    behind_.insert(behind_.end(), ahead.begin(), ahead.end());
    ahead.clear();
    if (m.count > 0) behind_.push_back(m);
  }
  for (std::vector<Message>& ahead : ahead_) {
    behind_.insert(behind_.end(), ahead.begin(), ahead.end());
    ahead.clear();
  }
  put_back(behind_);
}

void Commits::advance(int64_t known, int64_t end, const std::vector<int64_t>& origin,
                      const Brake& brake, const Out& out) {
  for (;;) {
    int64_t begin = points_.back().clock;
    if (points_.back().rest) {
      // Messages before the first motion need no commit.
      for (; waiting_.next_clock() < known && waiting_.front().kind == MessageKind::pin;
           waiting_.pop())
        out(waiting_.front());
      begin = std::max(begin, next_clock());
    }
    if (end != kNoMessage && !moving()) {
      if (!points_.back().rest) commit(std::max(end, begin), true, origin, false, out);
      for (; !waiting_.empty(); waiting_.pop()) out(waiting_.front());
      return;
    }
    if (begin == kNoMessage) return;
    int64_t clock = begin + period_;
    if (waiting_.size() > most_) clock = std::min(clock, waiting_[most_].clock);
    clock = std::max(clock, begin + 1);
    if (clock >= std::min(known, end)) {
      if (end == kNoMessage) return;
      commit(std::max(end, last_end()), true, origin, false, out);
      continue;
    }
    past_.clear();
    moves_.clear();
    brake(clock, past_, moves_);
    const bool braking = !past_.empty() || !moves_.empty();
    commit(clock, !braking && next_clock() > clock + period_, origin, braking, out);
  }
}

void Commits::commit(int64_t clock, bool rest, const std::vector<int64_t>& origin, bool braking,
                     const Out& out) {
  Point p{++serial_, clock, rest, braking ? length_of(moves_) : 0};
  divide(clock);
  // The link sends a message when its end is near enough. Sorted by end, no message waits for one
  // that lasts longer.
  std::stable_sort(within_.begin(), within_.end(),
                   [](const Message& a, const Message& b) { return a.end_clock < b.end_clock; });
  for (const Message& m : within_) out(m);
  if (braking) tail(clock, origin, out);
  out({clock, clock, p.serial, 0, 0, 0, MessageKind::commit, uint8_t(rest)});
  points_.push_back(std::move(p));
}

double Commits::solve_tail(int64_t clock) {
  for (Move& m : past_) m.tolerance = widest_;
  for (Move& m : moves_) m.tolerance = widest_;
  const size_t n = solvers_.size();
  double end = double(clock);
  if (!machine_.filters.on()) {
    for (size_t i = 0; i < n; ++i)
      for (const Move& m : moves_) solvers_[i].solve(m, compressors_[i].steps());
    return std::max(end, moves_.back().end());
  }
  const bool nozzle = nozzle_.needed();
  if (nozzle) nozzle_.restart(end, past_);
  for (size_t i = 0; i < n; ++i) filtered_[i].restart(end, past_, solvers_[i]);
  if (nozzle) nozzle_.solve(moves_, kInfinity, true);
  for (size_t i = 0; i < n; ++i)
    filtered_[i].solve(moves_, kInfinity, true, solvers_[i], compressors_[i].steps());
  for (const std::vector<Move>* moves : {&past_, &moves_})
    for (const Move& m : *moves) end = std::max(end, m.end());
  return end + machine_.filters.memory(machine_.clock_hz);
}

void Commits::tail(int64_t clock, const std::vector<int64_t>& origin, const Out& out) {
  for (size_t i = 0; i < solvers_.size(); ++i) {
    Compressor& c = compressors_[i];
    c.restart(last_[i], {});
    c.not_before(clock);
    c.renew(renew_[i]);
    solvers_[i].set_count(origin[i] + net_[i]);
    solvers_[i].set_lead(original_[i].lead());
  }
  const double end = solve_tail(clock);
  for (Compressor& c : compressors_) {
    c.advance(end, true, clock);
    // A tail is never revoked. Tail messages do not wait, so the compressor may forget at once
    // which clocks it has set.
    c.forget_resets(kNoMessage);
    for (; !c.messages().empty(); c.messages().pop()) {
      Message m = c.messages().front();
      if (m.kind == MessageKind::set_dir) continue;
      if (m.kind == MessageKind::reset_clock) {
        m.interval = uint32_t(m.clock);
        m.count = 0;
      }
      m.kind = MessageKind::tail;
      m.clock = m.end_clock = clock;
      out(m);
    }
  }
}

}  // namespace passo
