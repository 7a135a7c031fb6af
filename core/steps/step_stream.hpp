// The steps of all motors and the changes of all outputs, as messages to each board in the order of
// their clocks. Messages that no board has taken yet can be revoked.
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

  // `with_steps` false: only for estimates, without motors.
  StepStream(const Machine& machine, bool with_steps, Brake brake);
  StepStream(const StepStream&) = delete;
  StepStream& operator=(const StepStream&) = delete;

  // The messages of one board. All clocks are those of the main board, number 0.
  MessageQueue& messages(size_t board) { return messages_[board]; }
  // Number of messages that no board has taken yet.
  size_t waiting();
  // While the result exists, the boards take no messages.
  std::unique_lock<std::recursive_mutex> hold() { return messages_[0].hold(); }
  // Latest end of all messages taken so far.
  int64_t taken_until() const;
  int64_t handed_out() const { return handed_out_; }  // latest clock of all messages so far

  const StepStatistics& statistics(size_t i) const { return compressors_[i].statistics(); }
  Compressor& compressor(size_t i) { return compressors_[i]; }
  size_t motors() const { return solvers_.size(); }
  int64_t count(size_t i) const { return solvers_[i].count(); }
  // Net steps of motor i from motion, without changes of its position by set_count() and
  // set_position().
  int64_t expected_net(size_t i) const { return solvers_[i].count() - set_apart_[i]; }
  // Sets the position of motor i without motion; here in steps.
  void set_count(size_t i, int64_t count);
  void set_position(size_t i, const double* position);
  // Steps of motor i beyond its position, which close the gap of its drive.
  int64_t lead(size_t i) const { return solvers_[i].lead(); }
  // Steps by which the lead of motor i differs from the full lead in the direction of its last
  // steps.
  int64_t taken_up(size_t i) const {
    return solvers_[i].lead() - filtered_[i].lead_after(compressors_[i].direction());
  }
  // Reads the gaps of the drives again; positions stay. Call this only at standstill.
  void use_gaps();
  // The last steps of motor i have closed the gap of its drive. Call set_position() after this.
  void lean(size_t i);
  // Reads the geometry of the machine again.
  void use_geometry() {
    for (StepSolver& solver : solvers_) solver.use_geometry();
  }
  // While `rests` is true, motor i makes no steps.
  void let_rest(size_t i, bool rests) { rests_[i] = rests; }
  // Motor i sends its clock and direction again before its next step. Call this only at standstill.
  void renew(size_t i) { compressors_[i].renew(); }
  void renew();

  void solve(const Piece& piece);
  // Solves the steps of moves, as far as later moves cannot change them. All moves up to `known`
  // are known. `last`: the machine stops after them.
  void solve(const std::vector<Move>& moves, double known, bool last);
  // After a cut at `clock`: the filters continue after the moves `past`.
  void restart_filters(double clock, const std::vector<Move>& past);
  // Makes commands of the solved steps. All later steps are at `clock` or after it. `still`: the
  // machine is at standstill at `clock`.
  void compress(double clock, bool still);
  // Sets an output at `ticks`, but not before messages that are handed out. Returns the clock.
  int64_t set_output(uint16_t target, uint32_t value, double ticks);
  int64_t not_before(double ticks) const;
  // Sets an output at `ticks`, also among messages that are handed out, as far as no board has
  // taken them.
  void set_output_among(uint16_t target, uint32_t value, double ticks);

  // Passes messages to the boards as far as no later message can come before them. All moves up to
  // `clock` are known. `all`: passes every message.
  void merge(double clock, bool all);
  // The machine is at standstill at `clock`. Call this after all messages are merged.
  void stand(double clock) { commit(kNoMessage, int64_t(std::ceil(clock))); }

  // Revokes everything after `at`, which no board has taken yet. Each motor goes back to its last
  // step that remains. Steps that wait may be due before `at`, so all steps before `clock` become
  // commands first.
  void revoke(int64_t at, double clock);
  // Later calls do not revoke or read anything before `past`.
  void forget(int64_t past);

  // From now on messages are grouped in commits (commits.hpp) of at most `period` ticks and `most`
  // messages. Call this only at standstill, with no message waiting; commits start at `clock`. The
  // last kKeptCommits that were taken are kept for rewind().
  void use_commits(int64_t period, size_t most, int64_t clock);
  void stop_commits() { commits_.reset(); }
  bool commits() const { return commits_.has_value(); }
  // The earliest clock to which rewind() can go back. Call this only with commits.
  int64_t oldest_commit() const { return commits_->points().front().clock; }
  // Goes back to the end of commit `serial`: later messages were not executed, and wait again.
  // Returns the commit. If it is no longer known, returns nothing and changes nothing.
  std::optional<Commits::Point> rewind(uint32_t serial);
  // For each motor, the net steps from the stop after commit `serial` to the stop after commit
  // `next`, each including its tail. Returns nothing if the commits are not consecutive, or no
  // longer known.
  std::optional<std::vector<int64_t>> between_stops(uint32_t serial, uint32_t next);
  // Revokes the messages of the stop that the boards have made by themselves, and returns the
  // outputs among them. Call this after rewind() and after that stop is planned. The machine is at
  // standstill at `clock`.
  std::vector<Message> resume_at_rest(uint32_t serial, int64_t clock);

 private:
  static constexpr size_t kKeptCommits =
      128;  // more than all frames that are not acknowledged can hold
  const Machine& machine_;
  Brake brake_;
  std::vector<StepSolver> solvers_;
  NozzleLaw nozzle_;
  std::deque<FilteredSolver> filtered_;  // used while filters are on
  std::vector<bool> rests_;              // motors that make no steps at present
  std::vector<int64_t> set_apart_;       // sum of the changes by set_count()
  std::deque<Compressor> compressors_;
  std::deque<MessageQueue> messages_;  // for each board
  MessageQueue outputs_;
  std::optional<Commits> commits_;
  std::vector<MessageQueue*> merged_;  // outputs_, and the queues of the compressors
  std::vector<int64_t> next_clocks_;   // for each of merged_
  int64_t handed_out_ = 0;

  // The queue of the board that a message is for.
  MessageQueue& queue_of(const Message& m);
  std::vector<int64_t> nets() const;
  std::vector<bool> renews() const;
  // Restarts the commits at standstill; `serial` is the last commit of the boards.
  void begin_commits(uint32_t serial, int64_t clock);
  // Passes on the settled messages. `stands`: clock of the standstill, or kNoMessage.
  void commit(int64_t known, int64_t stands);
  // The parameter of MessageQueue::behind() for this commit.
  int64_t last_of(const Commits::Point& p) const;
  static bool sooner(const Message& a, const Message& b) { return a.clock < b.clock; }
  // Moves the remaining messages that belong to no commit to `open`.
  void revoke(MessageQueue& queue, int64_t at, Revocation& revoked, std::vector<Message>& open);
};

}  // namespace passo
