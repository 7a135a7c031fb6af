// Decides which messages remain when motion is cut at a clock.
#pragma once
#include <cstdint>
#include <functional>
#include <vector>

#include "steps/compressor.hpp"
#include "steps/message_queue.hpp"

namespace passo {

struct Revocation {
  std::vector<StepStatistics>
      lost;                   // for each motor: steps, net steps and commands that were revoked
  std::vector<int64_t> last;  // for each motor: clock of the last step that remains

  explicit Revocation(size_t motors) : lost(motors), last(motors), cut_off_(motors, false) {}

  using BeforeReset = std::function<int64_t(const Message& reset)>;
  // Empties the queue and returns the messages that are executed up to `at`. A command is shortened
  // to its steps up to `at`. Directions and clocks belong to the steps after them.
  // before_reset(reset) returns the motor's clock before that reset.
  std::vector<Message> keep(MessageQueue& queue, int64_t at, const BeforeReset& before_reset);

 private:
  std::vector<bool> cut_off_;

  // Counts all but the first `count` steps of a command as revoked.
  void lose(const Message& m, int64_t count, int64_t start);
};

}  // namespace passo
