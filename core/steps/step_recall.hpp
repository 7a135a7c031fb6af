// Which messages are left when motion is cut at a clock.
#pragma once
#include <algorithm>
#include <cstdint>
#include <vector>

#include "plan/statistics.hpp"
#include "steps/message_queue.hpp"

namespace passo {

struct Revocation {
  std::vector<StepStatistics> lost;  // of each motor: steps, net steps and commands
  std::vector<int64_t> last;  // clock of its last step; of the last one kept, if some are lost

  explicit Revocation(size_t motors) : lost(motors), last(motors), cut_off_(motors, false) {}

  // Empties the queue. Returns what of it is executed up to `at`: a command is cut short behind its
  // last step, and directions and clocks go with the steps behind them. `before_reset(reset)` is
  // the clock that a motor had before.
  template <typename BeforeReset>
  std::vector<Message> keep(MessageQueue& queue, int64_t at, BeforeReset&& before_reset) {
    std::vector<Message> kept;
    std::vector<std::vector<Message>> ahead(lost.size());
    for (size_t i = 0; i < queue.size(); ++i) {
      Message m = queue[i];
      if (m.kind == MessageKind::pin || m.kind == MessageKind::tail ||
          m.kind == MessageKind::commit) {
        if (m.clock <= at) kept.push_back(m);
        continue;
      }
      std::vector<Message>& before = ahead[m.target];
      if (m.kind != MessageKind::queue_step) {
        before.push_back(m);
        continue;
      }
      const int64_t count = m.steps_until(at);
      int64_t start = m.start();
      if (count > 0) {
        for (Message& b : before) {
          b.end_clock = std::min(b.end_clock, start + m.span(count));
          kept.push_back(b);
        }
      } else {
        for (const Message& b : before)
          if (b.kind == MessageKind::reset_clock) start = before_reset(b);
      }
      before.clear();
      if (count < m.count) lose(m, count, start);
      if (count == 0) continue;
      m.count = uint16_t(count);
      m.end_clock = start + m.span(count);
      kept.push_back(m);
    }
    queue.clear();
    return kept;
  }

 private:
  std::vector<bool> cut_off_;

  // All but the first `count` steps of a command.
  void lose(const Message& m, int64_t count, int64_t start) {
    StepStatistics& of = lost[m.target];
    of.steps += m.count - count;
    of.net += m.dir ? m.count - count : count - m.count;
    if (count == 0) ++of.commands;
    if (!cut_off_[m.target]) last[m.target] = start + m.span(count);
    cut_off_[m.target] = true;
  }
};

}  // namespace passo
