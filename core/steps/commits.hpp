// Motion in commits, for boards that outlive their links (docs/decisions/0013-survive.md): messages
// are handed out up to a clock at which all motors are cut, with the moves that would stop the
// machine on its path from there.
#pragma once
#include <algorithm>
#include <cstdint>
#include <deque>
#include <vector>

#include "plan/braking.hpp"
#include "steps/compressor.hpp"
#include "steps/message_queue.hpp"
#include "steps/step_solver.hpp"

namespace passo {

class Commits {
 public:
  struct Point {
    uint32_t serial;
    int64_t clock;
    bool rest;   // the machine stands there
    double way;  // on which it would stop from there
  };

  // A commit spans `period` ticks, and fewer where more than `most` messages would be in it.
  Commits(const Machine& machine, int64_t period, size_t most)
      : period_(period), most_(std::max<size_t>(most, 1)),
        widest_(std::max(kTailTolerance * machine.clock_hz, machine.widest_tolerance())) {
    for (size_t i = 0; i < machine.steppers.size(); ++i) {
      solvers_.emplace_back(machine, machine.steppers[i]);
      compressors_.emplace_back(machine, machine.steppers[i], uint16_t(i));
    }
  }

  MessageQueue& waiting() { return waiting_; }
  const std::deque<Point>& points() const { return points_; }
  // All motors stand, nothing waits, and the boards' last commit was `serial`: the clocks of their
  // last steps, their net steps, and whether their clocks must be told anew.
  void begin(uint32_t serial, int64_t clock, std::vector<int64_t> last, std::vector<int64_t> net,
             std::vector<bool> renew) {
    last_ = std::move(last);
    net_ = std::move(net);
    renew_ = std::move(renew);
    begin_ = serial;
    points_.assign(1, {serial, clock, true, 0});
  }
  // Whether no message of any later commit had been taken when this one was the board's last.
  bool begins_with(const Point& p) const { return p.serial == begin_; }
  // The point of a commit that is still known; end of points() if it is not.
  std::deque<Point>::const_iterator find(uint32_t serial) const {
    return std::find_if(points_.begin(), points_.end(),
                        [&](const Point& p) { return p.serial == serial; });
  }

  // Gives to `out` all that is certain, every message below `known` being in waiting().
  // `brake(clock, moves)` gives the way on which the machine would stop; `origin` is what each
  // motor's count is at a net of 0. `end`: that is where the machine stands; kNoMessage if it does
  // not.
  template <typename Brake, typename Out>
  void advance(int64_t known, int64_t end, const std::vector<int64_t>& origin, Brake&& brake,
               Out&& out) {
    for (;;) {
      int64_t begin = points_.back().clock;
      if (points_.back().rest) {
        // What comes before any motion needs no commit.
        for (; waiting_.next_clock() < known && waiting_.front().kind == MessageKind::pin;
             waiting_.pop())
          out(waiting_.front());
        begin = std::max(begin, next_clock());
      }
      if (end != kNoMessage && !moving()) {
        if (!points_.back().rest) commit(std::max(end, begin), true, origin, {}, out);
        for (; !waiting_.empty(); waiting_.pop()) out(waiting_.front());
        return;
      }
      if (begin == kNoMessage) return;
      int64_t clock = begin + period_;
      if (waiting_.size() > most_) clock = std::min(clock, waiting_[most_].clock);
      clock = std::max(clock, begin + 1);
      if (clock >= std::min(known, end)) {
        if (end == kNoMessage) return;
        commit(std::max(end, last_end()), true, origin, {}, out);
        continue;
      }
      moves_.clear();
      brake(clock, moves_);
      commit(clock, moves_.empty() && next_clock() > clock + period_, origin, moves_, out);
    }
  }

  // A cut at `clock`: commits later than that are void, and what was in them waits again.
  void revoke(int64_t clock) {
    while (points_.size() > 1 && points_.back().clock > clock) points_.pop_back();
  }
  // After that: of each motor the clock of the last step that does not wait, if none does, and the
  // net steps of all that it has and that wait, and whether its clock must be told anew before what
  // does not wait.
  void resume(std::vector<int64_t> last, std::vector<int64_t> net, std::vector<bool> renew) {
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
  // Messages that follow the last commit, in their order, before all that waits already.
  void put_back(const std::vector<Message>& messages) {
    for (auto m = messages.rbegin(); m != messages.rend(); ++m) waiting_.push_front(*m);
  }
  // Of those that were taken, until a clock, no more than so many will be asked for.
  void forget(int64_t taken_until, size_t kept) {
    while (points_.size() > kept && points_[kept].clock <= taken_until) points_.pop_front();
  }

 private:
  static constexpr double kTailTolerance = 50e-6;  // s: nothing is printed on the way to a stop

  uint32_t serial_ = 0, begin_ = 0;  // of the last commit made; of the board's last at begin()
  int64_t period_;
  size_t most_;
  double widest_;
  std::deque<StepSolver> solvers_;
  std::deque<Compressor> compressors_;
  MessageQueue waiting_;
  std::deque<Point> points_;
  std::vector<int64_t> last_, net_;  // of each motor, of all that does not wait
  std::vector<bool> renew_;          // its clock must be told anew before its next step
  std::vector<Move> moves_;
  std::vector<Message> within_, behind_;
  std::vector<std::vector<Message>> ahead_;  // directions and clocks go with the steps behind them

  int64_t next_clock() const {
    for (size_t i = 0; i < waiting_.size(); ++i)
      if (waiting_[i].kind != MessageKind::pin) return waiting_[i].clock;
    return kNoMessage;
  }
  bool moving() const { return next_clock() != kNoMessage; }
  int64_t last_end() const {
    int64_t end = 0;
    for (size_t i = 0; i < waiting_.size(); ++i) end = std::max(end, waiting_[i].end_clock);
    return end;
  }

  template <typename Out>
  void commit(int64_t clock, bool rest, const std::vector<int64_t>& origin,
              const std::vector<Move>& moves, Out&& out) {
    Point p{++serial_, clock, rest, length_of(moves)};
    divide(clock);
    // A link hands each out when its end is near enough: none may wait for one that lasts longer.
    std::stable_sort(within_.begin(), within_.end(),
                     [](const Message& a, const Message& b) { return a.end_clock < b.end_clock; });
    for (const Message& m : within_) out(m);
    if (!moves.empty()) tail(clock, origin, moves, out);
    out({clock, clock, p.serial, 0, 0, 0, MessageKind::commit, uint8_t(rest)});
    points_.push_back(std::move(p));
  }

  // Takes from what waits all that comes up to a clock, and splits what reaches over it.
  void divide(int64_t clock) {
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
          a.end_clock = first.end_clock;  // it goes with the steps behind it
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

  template <typename Out>
  void tail(int64_t clock, const std::vector<int64_t>& origin, const std::vector<Move>& moves,
            Out&& out) {
    for (size_t i = 0; i < solvers_.size(); ++i) {
      Compressor& c = compressors_[i];
      c.restart(last_[i], {});
      c.not_before(clock);
      c.renew(renew_[i]);
      solvers_[i].set_count(origin[i] + net_[i]);
      for (Move m : moves) {
        m.tolerance = widest_;
        solvers_[i].solve(m, c.steps());
      }
      c.advance(moves.back().end(), true, clock);
      // Nothing of it is ever taken back: whether the clock must be told anew is known here, of
      // what does not wait.
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
};

}  // namespace passo
