// Motion in commits, for boards that survive a lost link (docs/decisions/0013-survive.md). A commit
// contains all messages up to a clock at which every motor's motion is cut, and the moves that
// would stop the machine on its path from there (the tail).
#pragma once
#include <cstdint>
#include <deque>
#include <functional>
#include <vector>

#include "plan/braking.hpp"
#include "steps/compressor.hpp"
#include "steps/filtered_solver.hpp"
#include "steps/message_queue.hpp"
#include "steps/step_solver.hpp"

namespace passo {

class Commits {
 public:
  // Sets `moves` to the moves that stop the machine from `clock` on, and `past` to the moves before
  // `clock` that filters still need.
  using Brake =
      std::function<void(int64_t clock, std::vector<Move>& past, std::vector<Move>& moves)>;
  using Out = std::function<void(const Message&)>;
  struct Point {
    uint32_t serial;
    int64_t clock;
    bool rest;             // the machine is at standstill there
    double stop_distance;  // distance from there to the planned stop
  };

  // A commit spans `period` ticks, or less if it would contain more than `most` messages.
  // `original` and `filtered` solve the steps up to each commit.
  Commits(const Machine& machine, int64_t period, size_t most,
          const std::vector<StepSolver>& original, const std::deque<FilteredSolver>& filtered);

  MessageQueue& waiting() { return waiting_; }
  const std::deque<Point>& points() const { return points_; }
  // Restarts at standstill, with no message waiting, when `serial` is the last commit of the
  // boards. For each motor: the clock of its last step, its net steps, and whether its clock must
  // be sent again.
  void begin(uint32_t serial, int64_t clock, std::vector<int64_t> last, std::vector<int64_t> net,
             std::vector<bool> renew);
  // Whether no message after this commit had been taken at the last begin().
  bool begins_with(const Point& p) const { return p.serial == begin_; }
  // The point of a commit; points().end() if the commit is no longer known.
  std::deque<Point>::const_iterator find(uint32_t serial) const;

  // Passes all complete commits to `out`. waiting() must contain every message before `known`.
  // `origin`: the count of each motor at 0 net steps. `end`: the clock at which the machine stops;
  // kNoMessage if it does not.
  void advance(int64_t known, int64_t end, const std::vector<int64_t>& origin, const Brake& brake,
               const Out& out);

  // A cut at `clock`: drops the commits after it. Their messages wait again.
  void revoke(int64_t clock);
  // Continues after revoke(). For each motor: the clock of its last step, its net steps including
  // those that wait, and whether its clock must be sent again.
  void resume(std::vector<int64_t> last, std::vector<int64_t> net, std::vector<bool> renew);
  // Inserts messages before those that wait.
  void put_back(const std::vector<Message>& messages);
  // Drops all but the last `kept` of the commits that were taken until a clock.
  void forget(int64_t taken_until, size_t kept);

 private:
  static constexpr double kTailTolerance =
      50e-6;  // 50 µs are enough, because the machine prints nothing during a stop

  uint32_t serial_ = 0, begin_ = 0;  // last commit made; last commit of the boards at begin()
  int64_t period_;
  size_t most_;
  double widest_;
  const Machine& machine_;
  const std::vector<StepSolver>& original_;
  std::deque<StepSolver> solvers_;
  NozzleLaw nozzle_;
  std::deque<FilteredSolver> filtered_;
  std::deque<Compressor> compressors_;
  MessageQueue waiting_;
  std::deque<Point> points_;
  std::vector<int64_t> last_, net_;  // of each motor, without the steps that wait
  std::vector<bool> renew_;          // for each motor: its clock must be sent before the next step
  std::vector<Move> past_, moves_;
  std::vector<Message> within_, behind_;
  std::vector<std::vector<Message>>
      ahead_;  // for each motor: directions and clocks before its next step

  int64_t next_clock() const;
  bool moving() const { return next_clock() != kNoMessage; }
  int64_t last_end() const;

  // Makes a commit. With `braking`, also plans the stop from there, along past_ and moves_.
  void commit(int64_t clock, bool rest, const std::vector<int64_t>& origin, bool braking,
              const Out& out);

  // Takes the messages up to a clock from those that wait. Splits commands that continue after it.
  void divide(int64_t clock);

  void tail(int64_t clock, const std::vector<int64_t>& origin, const Out& out);
  // Solves the steps of all motors along past_ and moves_. Returns the clock of their end.
  double solve_tail(int64_t clock);
};

}  // namespace passo
