// Motion in commits, for boards that outlive their links (docs/decisions/0013-survive.md): messages
// are handed out up to a clock at which all motors are cut, with the moves that would stop the
// machine on its path from there.
#pragma once
#include <cstdint>
#include <deque>
#include <functional>
#include <vector>

#include "plan/braking.hpp"
#include "steps/compressor.hpp"
#include "steps/message_queue.hpp"
#include "steps/step_solver.hpp"

namespace passo {

class Commits {
 public:
  // The way on which the machine would stop from a clock on.
  using Brake = std::function<void(int64_t clock, std::vector<Move>& moves)>;
  using Out = std::function<void(const Message&)>;
  struct Point {
    uint32_t serial;
    int64_t clock;
    bool rest;   // the machine stands there
    double way;  // on which it would stop from there
  };

  // A commit spans `period` ticks, and fewer where more than `most` messages would be in it.
  Commits(const Machine& machine, int64_t period, size_t most);

  MessageQueue& waiting() { return waiting_; }
  const std::deque<Point>& points() const { return points_; }
  // All motors stand, nothing waits, and the boards' last commit was `serial`: the clocks of their
  // last steps, their net steps, and whether their clocks must be told anew.
  void begin(uint32_t serial, int64_t clock, std::vector<int64_t> last, std::vector<int64_t> net,
             std::vector<bool> renew);
  // Whether no message of any later commit had been taken when this one was the board's last.
  bool begins_with(const Point& p) const { return p.serial == begin_; }
  // The point of a commit that is still known; end of points() if it is not.
  std::deque<Point>::const_iterator find(uint32_t serial) const;

  // Gives to `out` all that is certain, every message below `known` being in waiting().
  // `brake(clock, moves)` gives the way on which the machine would stop; `origin` is what each
  // motor's count is at a net of 0. `end`: that is where the machine stands; kNoMessage if it does
  // not.
  void advance(int64_t known, int64_t end, const std::vector<int64_t>& origin, const Brake& brake,
               const Out& out);

  // A cut at `clock`: commits later than that are void, and what was in them waits again.
  void revoke(int64_t clock);
  // After that: of each motor the clock of the last step that does not wait, if none does, and the
  // net steps of all that it has and that wait, and whether its clock must be told anew before what
  // does not wait.
  void resume(std::vector<int64_t> last, std::vector<int64_t> net, std::vector<bool> renew);
  // Messages that follow the last commit, in their order, before all that waits already.
  void put_back(const std::vector<Message>& messages);
  // Of those that were taken, until a clock, no more than so many will be asked for.
  void forget(int64_t taken_until, size_t kept);

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

  int64_t next_clock() const;
  bool moving() const { return next_clock() != kNoMessage; }
  int64_t last_end() const;

  void commit(int64_t clock, bool rest, const std::vector<int64_t>& origin,
              const std::vector<Move>& moves, const Out& out);

  // Takes from what waits all that comes up to a clock, and splits what reaches over it.
  void divide(int64_t clock);

  void tail(int64_t clock, const std::vector<int64_t>& origin, const std::vector<Move>& moves,
            const Out& out);
};

}  // namespace passo
