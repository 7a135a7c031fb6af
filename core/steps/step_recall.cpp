#include "steps/step_recall.hpp"

namespace passo {

void Revocation::lose(const Message& m, int64_t count, int64_t start) {
  StepStatistics& of = lost[m.target];
  of.steps += m.count - count;
  of.net += m.dir ? m.count - count : count - m.count;
  if (count == 0) ++of.commands;
  if (!cut_off_[m.target]) last[m.target] = start + m.span(count);
  cut_off_[m.target] = true;
}

std::vector<Message> Revocation::keep(MessageQueue& queue, int64_t at,
                                      const BeforeReset& before_reset) {
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

}  // namespace passo
