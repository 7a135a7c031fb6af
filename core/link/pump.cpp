#include "link/pump.hpp"

#include <algorithm>

namespace passo::wire {

Pump::Pump(Link& link, Device& device, Ticks start, double (*cpu_clock)())
    : now_(start), cpu_clock_(cpu_clock) {
  attach(link, device);
}

void Pump::attach(Link& link, Device& device) {
  for (End& end : ends_)
    if (end.device == &device) {
      end.link = &link;
      return;
    }
  ends_.push_back({&link, &device, ends_.empty() ? 1 : link.hz() / ends_[0].link->hz(), {}, {}});
}

Ticks Pump::board_clock(const Link& link) const {
  for (const End& end : ends_)
    if (end.link == &link && link.synchronous()) return link.clock().clock_at(end.own(now_));
  return now_;
}

void Pump::sleep(Ticks until) {
  now_ = std::max(now_, until);
  for (End& end : ends_) end.device->poll(end.own(now_), end.up);
}

double Pump::device_share() const {
  return device_cpu_ > 0 ? device_cpu_ / (device_cpu_ + link_cpu_) : 0;
}

void Pump::record(bool on) {
  recording_ = on;
  recorded_.clear();
}

Stop Pump::run(Ticks until, bool until_heaters) {
  for (Ticks report_due = kNever;;) {
    if (cut_) return Stop::closed;
    Ticks next = this->next();
    bool any_stopped = false, all_stopped = true, fault = false, reached = until_heaters;
    for (End& end : ends_) {
      any_stopped |= end.link->shut_down();
      all_stopped = all_stopped && end.link->shut_down();
      fault |= end.link->take_fault();
      reached = reached && end.link->heaters_reached();
    }
    if (any_stopped) {
      report_due = std::min(report_due, now_ + Ticks(kNewsSeconds * ends_[0].link->hz()));
      if (all_stopped || now_ >= report_due) return Stop::shutdown;
      next = std::min(next, report_due);
    }
    if (fault) return Stop::fault;
    if (reached) return Stop::heaters;
    if (arrive(next, any_stopped ? kNever : until)) return Stop::time;
  }
}

void Pump::stand_by(Ticks until) {
  if (cut_) return sleep(until);
  while (!arrive(next(), until)) {
  }
}

Ticks Pump::next() {
  Ticks next = exchange();
  for (End& end : ends_) next = std::min(next, end.host(end.device->next_deadline()));
  return next;
}

bool Pump::arrive(Ticks next, Ticks until) {
  if (next <= until) {
    now_ = std::max(next, now_);
    return false;
  }
  now_ = std::max(now_, until);
  // Nothing is due; they only receive the time.
  for (End& end : ends_) end.device->poll(end.own(now_), end.up);
  return true;
}

Ticks Pump::exchange() {
  for (;;) {
    Ticks next = kNever;
    bool moved = false;
    for (End& end : ends_) next = std::min(next, end.host(exchange(end, moved)));
    if (!moved || ends_.size() == 1) return next;
  }
}

Ticks Pump::exchange(End& end, bool& moved) {
  const Ticks now = end.own(now_);
  for (;;) {
    bool sampled = cpu_clock_ && exchanges_++ % kSample == 0;
    if (sampled) cpu_clock_();  // the first call after a pause is slower than the next
    double begun = clock(sampled), asked = clock(sampled);
    end.down.clear();
    Ticks next = end.link->poll(now, end.down);
    if (recording_ && &end == &ends_[0])
      recorded_.insert(recorded_.end(), end.down.begin(), end.down.end());
    double sent = clock(sampled);
    if (!end.down.empty()) end.device->feed(end.down.data(), end.down.size(), now);
    end.device->poll(now, end.up);
    double polled = clock(sampled);
    const bool answered = !end.up.empty();
    moved |= !end.down.empty() || answered;
    const bool again = answered && end.link->feed(end.up.data(), end.up.size(), now);
    end.up.clear();
    if (sampled) {
      double reading = asked - begun;  // the time that reading the clock takes
      device_cpu_ += polled - sent - reading;
      link_cpu_ += sent - asked + clock(true) - polled - 2 * reading;
    }
    if (!again) return next;
  }
}

}  // namespace passo::wire
