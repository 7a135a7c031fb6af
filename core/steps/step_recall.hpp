// Which messages remain when motion is cut at a clock.
#pragma once
#include <cstdint>
#include <functional>
#include <vector>

#include "steps/compressor.hpp"
#include "steps/message_queue.hpp"

namespace passo {

struct Revocation {
  std::vector<StepStatistics> lost;  // of each motor: steps, net steps and commands
  std::vector<int64_t> last;  // clock of its last step; of the last one kept, if some are lost

  explicit Revocation(size_t motors) : lost(motors), last(motors), cut_off_(motors, false) {}

  using BeforeReset = std::function<int64_t(const Message& reset)>;
  // Empties the queue. Returns the part of it that is executed up to `at`: a command is cut short
  // after its last step, and directions and clocks go with the steps after them.
  // `before_reset(reset)` is the clock that a motor had before.
  std::vector<Message> keep(MessageQueue& queue, int64_t at, const BeforeReset& before_reset);

 private:
  std::vector<bool> cut_off_;

  // All but the first `count` steps of a command.
  void lose(const Message& m, int64_t count, int64_t start);
};

}  // namespace passo
