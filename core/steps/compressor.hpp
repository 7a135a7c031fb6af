// Steps of one motor → commands for the board. The result depends only on the times of the steps,
// never on how they arrived.
#pragma once
#include <algorithm>
#include <cstdint>
#include <deque>
#include <limits>
#include <memory>
#include <vector>

#include "machine/machine.hpp"
#include "steps/message_queue.hpp"
#include "steps/steps.hpp"

namespace passo {

struct StepStatistics {
  int64_t steps = 0, net = 0, commands = 0, dropped_pairs = 0;
  double error_max = 0, error_square = 0;  // ticks, ticks²: executed against ideal
};

// Every clock is after this one.
inline constexpr int64_t kAnyClock = std::numeric_limits<int64_t>::min();
struct Command;
class Stabbing;

class Compressor {
 public:
  Compressor(const Machine& machine, const StepperSpec& spec, uint16_t target);
  ~Compressor();

  // The solver appends here.
  Steps& steps() { return steps_; }
  MessageQueue& messages() { return messages_; }
  const StepStatistics& statistics() const { return statistics_; }
  // Ideal ticks of the steps made into commands since the caller last cleared it, if asked for.
  std::vector<double>& ideal() { return ideal_; }
  void keep_ideal(bool on) { keeps_ideal_ = on; }
  int64_t last() const { return last_; }
  int direction() const { return dir_; }  // of the last command; 0: none so far

  // Makes commands of all steps that can no longer change. All steps before `frontier` are known.
  // `still`: no further step follows until the machine has been at standstill. No step is scheduled
  // at or before `behind`.
  void advance(double frontier, bool still, int64_t behind);

  // No later message has a clock before this one.
  double next_clock(double frontier) const;

  // No command may be due before this clock: messages up to it are handed out already.
  void not_before(int64_t clock) { floor_ = clock; }

  // The motor has stopped by itself: its clock and direction are set again before its next step.
  void renew(bool on = true);
  bool renews() const { return renew_; }

  // The last step before the clock was set again at `clock`.
  int64_t before_reset(int64_t clock) const;
  // Clocks that were set before `clock` can no longer be revoked.
  void forget_resets(int64_t clock);

  // Net steps that were solved but not made into commands.
  int64_t pending_net() const;

  // A cut: the motor's last step is executed at `last`, what is pending is forgotten and `revoked`
  // is taken back from the statistics. Steps that follow keep their minimum distance from that
  // step. If the clock was set again after that step, and had to be, it is set again.
  void restart(int64_t last, const StepStatistics& revoked);

 private:
  static constexpr double kMaxSeconds = 0.06;   // maximum span of a command: bounds how long steps
                                                // wait for more steps, and how long a hold waits
  static constexpr double kLeadSeconds = 0.02;  // a command is due this long before its first step
  // Number of steps whose windows are calculated at once: so a move of millions of steps needs
  // little more memory than their times. The remainder of a block must hold the longest command.
  static constexpr size_t kBlock = 1 << 14;
  static constexpr int kLook = 512;           // steps examined first: most commands are shorter
  static constexpr double kIdle = 268435456;  // ticks: after a longer gap the clock is set again

  double tolerance_, reversal_, least_, longest_, lead_, margin_;
  uint16_t target_;
  Steps steps_;                             // ticks[0] is the step before the first pending one
  size_t joined_ = 0;                       // runs before this one are checked for close reversals
  size_t base_ = 0;                         // index in `ticks` of the first element of these
  std::vector<double> lo_, hi_, executed_;  // three more than a block, as Stabbing requires
  std::unique_ptr<Stabbing> stabbing_;
  MessageQueue messages_;
  StepStatistics statistics_;
  int64_t last_ = 0;  // executed clock of the last step compressed
  int dir_ = 0;
  int64_t floor_ = 0, behind_ = kAnyClock;
  struct Reset {
    int64_t at, before;  // clock set, last step before it
    bool renewed;        // renew() had requested it
  };
  std::deque<Reset> resets_;
  bool crowded_ = true, keeps_ideal_ = false, renew_ = false;
  std::vector<double> ideal_;

  // Where the motor turns, opposite steps that are too close for the driver cancel each other.
  void drop_close_reversals();
  // Run r or the one before it may have lost all its steps; neighbours of one direction then join.
  void remove_empty(size_t r);

  // The minimum distance of a step from an executed one, in either direction.
  double apart() const { return std::max(reversal_, least_); }
  bool resets(double first) const { return renew_ || first - double(last_) > kIdle; }

  // After a cut or a stop a step may be due at once, at or before the last executed one, or when
  // the clock has to be set again.
  void set_apart();

  // Returns the index of the first step that still waits.
  size_t compress_all(size_t known, double frontier, bool still);

  // Windows of the steps from index `from` to `to`; a further one is read.
  void prepare(size_t from, size_t to);
  // Around a reversal executed steps keep pulse, hold and set-up apart, and a pause as a pulse.
  double half_turn(size_t b) const;
  void narrow(size_t k, double half);

  // Makes commands of the steps from index i on, of which those before `known` are known in this
  // block. Returns the index of the first step that is left for the next block, or still waits.
  size_t compress(size_t i, size_t known, bool last, double frontier, bool still);

  // The block's steps before index `done` have become commands. Returns `done`.
  size_t check(size_t done);

  int64_t due(double first) const;

  void reset_clock(double first);

  void emit(int dir, size_t i, const Command& c, int64_t span);

  // Drops the steps before index `done`, keeping the last of them as ticks[0].
  void forget(size_t done);
};

}  // namespace passo
