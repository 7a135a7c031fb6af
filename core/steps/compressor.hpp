// Compresses the steps of one motor to commands for the board. The result depends only on the times
// of the steps, not on the portions in which they arrive.
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
  double error_max = 0, error_square = 0;  // executed time less ideal time: ticks, ticks²
};

// Earlier than any clock.
inline constexpr int64_t kAnyClock = std::numeric_limits<int64_t>::min();
struct Command;
class Stabbing;

class Compressor {
 public:
  Compressor(const Machine& machine, const StepperSpec& spec, uint16_t target);
  ~Compressor();

  // The solver appends steps here.
  Steps& steps() { return steps_; }
  MessageQueue& messages() { return messages_; }
  const StepStatistics& statistics() const { return statistics_; }
  // Ideal times of the steps in commands, if keep_ideal() is on; the caller clears them.
  std::vector<double>& ideal() { return ideal_; }
  void keep_ideal(bool on) { keeps_ideal_ = on; }
  int64_t last() const { return last_; }
  int direction() const { return dir_; }  // of the last command; 0: no command yet

  // Makes commands of all steps that cannot change any more. All steps before `frontier` are known.
  // `still`: the machine is at standstill before the next step. No step is executed at or before
  // `behind`.
  void advance(double frontier, bool still, int64_t behind);

  // All later messages have at least this clock.
  double next_clock(double frontier) const;

  // All later commands are due at this clock or later, because messages up to it are handed out.
  void not_before(int64_t clock) { floor_ = clock; }

  // The motor has stopped by itself: sends its clock and direction again before its next step.
  void renew(bool on = true);
  bool renews() const { return renew_; }

  // Clock of the last step before the motor's clock was set to `clock`.
  int64_t before_reset(int64_t clock) const;
  // Clocks that were set before `clock` cannot be revoked any more.
  void forget_resets(int64_t clock);

  // Net steps that are solved but not in commands yet.
  int64_t pending_net() const;

  // Cuts motion. The motor's last step is the one at `last`; pending steps are dropped, and
  // `revoked` is subtracted from the statistics. Later steps keep the minimum distance from `last`.
  // If renew() had set the clock after `last`, the clock is set again.
  void restart(int64_t last, const StepStatistics& revoked);

 private:
  static constexpr double kMaxSeconds =
      0.06;  // maximum span of a command: steps and feed holds wait at most this long
  static constexpr double kLeadSeconds = 0.02;  // a command is sent this long before its first step
  // Steps whose windows are calculated together. This limits the memory for moves of millions of
  // steps. A block must be longer than the longest command.
  static constexpr size_t kBlock = 1 << 14;
  static constexpr int kLook = 512;  // first attempt: most commands are shorter
  static constexpr double kIdle =
      268435456;  // ticks without a step after which the clock is set again

  double tolerance_, reversal_, least_, longest_, lead_, margin_;
  uint16_t target_;
  Steps steps_;                             // ticks[0] is the last step in a command
  size_t joined_ = 0;                       // close reversals before this run are removed
  size_t base_ = 0;                         // index in `ticks` of lo_[0], hi_[0] and executed_[0]
  std::vector<double> lo_, hi_, executed_;  // three elements longer than a block, for Stabbing
  std::unique_ptr<Stabbing> stabbing_;
  MessageQueue messages_;
  StepStatistics statistics_;
  int64_t last_ = 0;  // clock of the last step in a command
  int dir_ = 0;
  int64_t floor_ = 0, behind_ = kAnyClock;
  struct Reset {
    int64_t at, before;  // the clock that was set; last step before it
    bool renewed;        // caused by renew()
  };
  std::deque<Reset> resets_;
  bool crowded_ = true, keeps_ideal_ = false, renew_ = false;
  std::vector<double> ideal_;

  // Removes pairs of opposite steps at a turn that are too close for the driver.
  void drop_close_reversals();
  // Removes run r and the one before it if they are empty, and joins neighbours of the same
  // direction.
  void remove_empty(size_t r);

  // Minimum distance of a step from an executed step, for either direction.
  double apart() const { return std::max(reversal_, least_); }
  bool resets(double first) const { return renew_ || first - double(last_) > kIdle; }

  // Delays steps that are too early after a cut, after a stop, or when the clock must be set again.
  void set_apart();

  // Returns the index of the first step that waits for more steps.
  size_t compress_all(size_t known, double frontier, bool still);

  // Calculates the windows of the steps [from, to). Reads one step more.
  void prepare(size_t from, size_t to);
  // Half the window of the two steps around a reversal. It keeps the times for pulse, hold and
  // set-up between them.
  double half_turn(size_t b) const;
  void narrow(size_t k, double half);

  // Makes commands of the steps from index i on. In this block the steps before `known` are known.
  // Returns the index of the first step that is not in a command.
  size_t compress(size_t i, size_t known, bool last, double frontier, bool still);

  // Checks that the block's steps before index `done` are executed within their windows. Returns
  // `done`.
  size_t check(size_t done);

  int64_t due(double first) const;

  void reset_clock(double first);

  void emit(int dir, size_t i, const Command& c, int64_t span);

  // Drops the steps before index `done`, except the last of them, which becomes ticks[0].
  void forget(size_t done);
};

}  // namespace passo
