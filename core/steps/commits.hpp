// Motion in commits, for boards that survive the loss of their links
// (docs/decisions/0013-survive.md): messages are handed out up to a clock at which all motors are
// cut, with the moves that would stop the machine on its path from there.
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
  // Sets `moves` to those on which the machine would stop from `clock` on, and `past` to those
  // before it that filters still remember.
  using Brake =
      std::function<void(int64_t clock, std::vector<Move>& past, std::vector<Move>& moves)>;
  using Out = std::function<void(const Message&)>;
  struct Point {
    uint32_t serial;
    int64_t clock;
    bool rest;             // the machine is at rest there
    double stop_distance;  // from there to the planned stop
  };

  // A commit spans `period` ticks, and fewer where more than `most` messages would be in it.
  // `original`, `filtered`: what solves the steps up to each commit.
  Commits(const Machine& machine, int64_t period, size_t most,
          const std::vector<StepSolver>& original, const std::deque<FilteredSolver>& filtered);

  MessageQueue& waiting() { return waiting_; }
  const std::deque<Point>& points() const { return points_; }
  // All motors are at rest, no message waits, and the boards' last commit was `serial`. For each
  // motor: the clock of its last step, its net steps, and whether its clock must be sent again.
  void begin(uint32_t serial, int64_t clock, std::vector<int64_t> last, std::vector<int64_t> net,
             std::vector<bool> renew);
  // Whether no message of any later commit had been taken when this one was the board's last.
  bool begins_with(const Point& p) const { return p.serial == begin_; }
  // The point of a commit that is still known; end of points() if it is not.
  std::deque<Point>::const_iterator find(uint32_t serial) const;

  // Passes to `out` all commits that are complete; waiting() has every message before `known`.
  // `origin`: the count of each motor at 0 net steps. `end`: the clock at which the machine comes
  // to rest; kNoMessage if it does not.
  void advance(int64_t known, int64_t end, const std::vector<int64_t>& origin, const Brake& brake,
               const Out& out);

  // A cut at `clock`: later commits are void, and their messages wait again.
  void revoke(int64_t clock);
  // After revoke: of each motor the clock of its last step, its net steps with those that wait, and
  // whether its clock must be sent again.
  void resume(std::vector<int64_t> last, std::vector<int64_t> net, std::vector<bool> renew);
  // Inserts messages between the last commit and those that wait.
  void put_back(const std::vector<Message>& messages);
  // Of the commits taken until a clock, drops all but the last `kept`.
  void forget(int64_t taken_until, size_t kept);

 private:
  static constexpr double kTailTolerance = 50e-6;  // s: nothing is printed during a stop

  uint32_t serial_ = 0, begin_ = 0;  // of the last commit made; of the last commit of the board at
                                     // begin()
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
  std::vector<int64_t> last_, net_;  // of each motor, without steps that wait
  std::vector<bool> renew_;          // the clock must be sent again before the next step
  std::vector<Move> past_, moves_;
  std::vector<Message> within_, behind_;
  std::vector<std::vector<Message>> ahead_;  // directions and clocks belong to the steps after them

  int64_t next_clock() const;
  bool moving() const { return next_clock() != kNoMessage; }
  int64_t last_end() const;

  // `braking`: also plans the stop from there, on past_ and moves_.
  void commit(int64_t clock, bool rest, const std::vector<int64_t>& origin, bool braking,
              const Out& out);

  // Takes the messages up to a clock from those that wait, and splits commands across it.
  void divide(int64_t clock);

  void tail(int64_t clock, const std::vector<int64_t>& origin, const Out& out);
  // Solves the steps of all motors along these moves. Returns the clock of their end.
  double solve_tail(int64_t clock);
};

}  // namespace passo
