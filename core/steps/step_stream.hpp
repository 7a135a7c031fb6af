// The steps of all motors, and the changes of all outputs, as messages to each board in the order
// of their clocks; messages that no board has taken yet can be revoked.
#pragma once
#include <cmath>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <vector>

#include "machine/machine.hpp"
#include "steps/commits.hpp"
#include "steps/compressor.hpp"
#include "steps/filtered_solver.hpp"
#include "steps/message_queue.hpp"
#include "steps/step_solver.hpp"

namespace passo {

struct Revocation;

class StepStream {
 public:
  using Brake = Commits::Brake;

  // `with_steps` false: no motor makes a step.
  StepStream(const Machine& machine, bool with_steps, Brake brake);
  StepStream(const StepStream&) = delete;
  StepStream& operator=(const StepStream&) = delete;

  // Of one board; all their clocks are those of the main one, 0.
  MessageQueue& messages(size_t board) { return messages_[board]; }
  // Messages that wait to be taken.
  size_t waiting();
  // While the result exists, boards take no messages.
  std::unique_lock<std::recursive_mutex> hold() { return messages_[0].hold(); }
  // Latest end of all messages taken so far.
  int64_t taken_until() const;
  int64_t handed_out() const { return handed_out_; }  // clock of the last of all messages so far

  const StepStatistics& statistics(size_t i) const { return compressors_[i].statistics(); }
  Compressor& compressor(size_t i) { return compressors_[i]; }
  size_t motors() const { return solvers_.size(); }
  int64_t count(size_t i) const { return solvers_[i].count(); }
  // Net steps that motor i was to make: its rounded targets, without positions that were set
  // without motion.
  int64_t expected_net(size_t i) const { return solvers_[i].count() - set_apart_[i]; }
  // Sets where motor i is, in steps, without motion.
  void set_count(size_t i, int64_t count);
  void set_position(size_t i, const double* position);
  // Steps by which motor i is beyond its position, to take up the gap of its drive.
  int64_t lead(size_t i) const { return solvers_[i].lead(); }
  // Steps by which motor i, after its last steps, is less beyond its position than it should be.
  int64_t taken_up(size_t i) const {
    return solvers_[i].lead() - filtered_[i].lead_after(compressors_[i].direction());
  }
  // The gaps in the drives may have changed: positions stay. Only at rest.
  void use_gaps();
  // The last steps of motor i have taken up the gap of its drive. set_position must follow.
  void lean(size_t i);
  // The machine has another geometry.
  void use_geometry() {
    for (StepSolver& solver : solvers_) solver.use_geometry();
  }
  // While `rests` is true, motor i makes no steps for the moves that are solved.
  void let_rest(size_t i, bool rests) { rests_[i] = rests; }
  // The next step of motor i sends its clock and direction again. Only at rest.
  void renew(size_t i) { compressors_[i].renew(); }
  void renew();

  void solve(const Piece& piece);
  // The steps of moves, as far as they are certain when all moves up to `known` are; `last`: the
  // machine comes to rest after them.
  void solve(const std::vector<Move>& moves, double known, bool last);
  // After a cut at `clock`: filters continue after the moves `past`.
  void restart_filters(double clock, const std::vector<Move>& past);
  // Makes commands of steps. No further step is before `clock`. `still`: the machine is at
  // standstill there.
  void compress(double clock, bool still);
  // An output's value, from `ticks` on. Returns its clock, which is not before the messages handed
  // out.
  int64_t set_output(uint16_t target, uint32_t value, double ticks);
  int64_t not_before(double ticks) const;
  // The same within the messages handed out, at a clock that no board has taken yet.
  void set_output_among(uint16_t target, uint32_t value, double ticks);

  // Passes to each board all messages that no later message can precede, when all moves up to
  // `clock` are known; `all`: every message.
  void merge(double clock, bool all);
  // After all is merged: the machine is at standstill at `clock`.
  void stand(double clock) { commit(kNoMessage, int64_t(std::ceil(clock))); }

  // Keeps what is executed up to `at`, which no board has taken yet, and sets every motor back to
  // its last step kept. First makes commands of all known steps before `clock`, because steps that
  // wait for more steps may be due before `at`.
  void revoke(int64_t at, double clock);
  // Nothing before `past` will be revoked or read any more.
  void forget(int64_t past);

  // From now on messages come in commits (commits.hpp): each of at most `period` ticks and `most`
  // messages. Only at standstill, from `clock` on, with nothing waiting. The last kKeptCommits that
  // were taken are kept for rewind().
  void use_commits(int64_t period, size_t most, int64_t clock);
  void stop_commits() { commits_.reset(); }
  bool commits() const { return commits_.has_value(); }
  // The earliest clock that rewind() can go back to; only with commits.
  int64_t oldest_commit() const { return commits_->points().front().clock; }
  // Goes back to the end of the commit `serial`: later messages have not been executed, and wait
  // again. Returns it; nothing, without any change, if that commit is not known any more.
  std::optional<Commits::Point> rewind(uint32_t serial);
  // For each motor, the net steps from the stop after commit `serial` to the stop after the
  // following commit `next`, each with its brake tail executed. Nothing if the commits are not
  // consecutive, or not known any more.
  std::optional<std::vector<int64_t>> between_stops(uint32_t serial, uint32_t next);
  // Call it after rewind() and after planning the stop that the boards have made by themselves.
  // Revokes the messages of that stop, and returns the outputs among them. The machine is at
  // standstill at `clock`.
  std::vector<Message> resume_at_rest(uint32_t serial, int64_t clock);

 private:
  static constexpr size_t kKeptCommits = 128;  // more than the frames on their way can hold
  const Machine& machine_;
  Brake brake_;
  std::vector<StepSolver> solvers_;
  NozzleLaw nozzle_;
  std::deque<FilteredSolver> filtered_;  // of the same motors, used while filters are on
  std::vector<bool> rests_;              // motors that make no steps for later moves
  std::vector<int64_t> set_apart_;       // steps by which positions were set without motion
  std::deque<Compressor> compressors_;
  std::deque<MessageQueue> messages_;  // by board
  MessageQueue outputs_;
  std::optional<Commits> commits_;
  std::vector<MessageQueue*> merged_;  // outputs_ and those of the compressors
  std::vector<int64_t> next_clocks_;   // of each of them
  int64_t handed_out_ = 0;

  // The queue of the board that gets a message.
  MessageQueue& queue_of(const Message& m);
  std::vector<int64_t> nets() const;
  std::vector<bool> renews() const;
  // The board's last commit is `serial`, and the machine is at standstill.
  void begin_commits(uint32_t serial, int64_t clock);
  // Passes on the settled messages; `stands` is the clock of the standstill, or kNoMessage.
  void commit(int64_t known, int64_t stands);
  // The name of the point for MessageQueue::behind().
  int64_t last_of(const Commits::Point& p) const;
  static bool sooner(const Message& a, const Message& b) { return a.clock < b.clock; }
  // Kept messages that belong to no commit are moved to `open`.
  void revoke(MessageQueue& queue, int64_t at, Revocation& revoked, std::vector<Message>& open);
};

}  // namespace passo
