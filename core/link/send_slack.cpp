#include "link/send_slack.hpp"

#include <algorithm>

namespace passo::wire {

void Lateness::restart() {
  for (Frame& f : frames_) f.need = kNever;
  for (Span& s : spans_) s = {};
  reason_ = Cause::plan;
}

void Lateness::woke(Ticks due, Ticks clock) {
  if (clock - due <= stall_) due = clock;
  hold(reason_, looked_, due);
  if (clock > due) {
    hold(Cause::stall, due, clock);
    longest_stall_ = std::max(longest_stall_, clock - due);
  }
  looked_ = clock;
}

void Lateness::looked(Cause reason, Ticks clock) {
  reason_ = reason;
  looked_ = clock;
}

void Lateness::left(uint64_t number, Ticks must, Ticks need, Ticks clock) {
  frames_[number % kFrames] = {must, need, clock};
}

void Lateness::arrived(uint64_t number, bool again, Ticks clock) {
  Frame& f = frames_[number % kFrames];
  if (f.need == kNever) return;
  // The answer may have waited for this program.
  Ticks deaf = overlap(Cause::stall, f.left, clock), transit = clock - f.left - deaf;
  Slack s{f.need - clock + deaf, f.need, 0, Cause::plan};
  for (size_t i = 0; i < kCauses; ++i) {
    Cause cause = Cause(i);
    Ticks held = overlap(cause, f.must, f.left);
    if (cause == (again ? Cause::retransmits : Cause::bytes)) held += transit;
    if (held > s.held) s.held = held, s.cause = cause;
  }
  f.need = kNever;
  if (s.cause == Cause::stall && s.held > 0) {  // all of it, as others would see it
    const Span& stall = spans_[size_t(Cause::stall)];
    s.held = stall.until - stall.from;
  }
  if (s.slack < late_) ++late_frames_[size_t(s.cause)];
  if (s.slack < recent_.slack) recent_ = s;
  if (s.slack < least_.slack) least_ = s;
}

void Lateness::hold(Cause cause, Ticks from, Ticks until) {
  Span& s = spans_[size_t(cause)];
  if (from > s.until) s.from = from;
  s.until = std::max(from, until);
}

Ticks Lateness::overlap(Cause cause, Ticks from, Ticks until) const {
  const Span& s = spans_[size_t(cause)];
  return std::max<Ticks>(0, std::min(s.until, until) - std::max(s.from, from));
}

}  // namespace passo::wire
