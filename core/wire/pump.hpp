// A link and a device in one process, in virtual time: from deadline to deadline, as fast as it
// goes.
#pragma once
#include <algorithm>

#include "device.hpp"
#include "link.hpp"
#include "stop.hpp"

namespace passo::wire {

class Pump {
 public:
  // Host time equals the device's clock and begins at `start`.
  // `cpu_clock` gives CPU seconds, or is null.
  Pump(Link& link, Device& device, Ticks start, double (*cpu_clock)() = nullptr)
      : link_(link), device_(device), now_(start), cpu_clock_(cpu_clock) {}

  Ticks now() const { return now_; }
  // The cable is cut: no byte arrives any more.
  void cut() { cut_ = true; }
  // CPU seconds of the device, from a sample of one exchange in kSample.
  double device_cpu() const { return device_cpu_; }
  // Bytes that the host sent, frames and all, from now on.
  void record(bool on) {
    recording_ = on;
    recorded_.clear();
  }
  Bytes& recorded() { return recorded_; }

  // Runs until virtual time reaches `until`, until the board stops, a heater fails, or, if asked,
  // until no heater is on its way to its target. The queue of the job must already hold all
  // messages whose clock is below `until` plus the horizon.
  Stop run(Ticks until, bool until_heaters) {
    for (;;) {
      if (cut_) return Stop::closed;
      Ticks next = exchange();
      if (link_.shut_down()) return Stop::shutdown;
      if (link_.take_fault()) return Stop::fault;
      if (until_heaters && link_.heaters_reached()) return Stop::heaters;
      next = std::min(next, device_.next_deadline());
      if (next > until) {
        now_ = std::max(now_, until);
        device_.poll(now_, up_);  // nothing is due, but it learns the time
        return Stop::time;
      }
      now_ = std::max(next, now_);
    }
  }

 private:
  Link& link_;
  Device& device_;
  Ticks now_;
  Bytes down_, up_, recorded_;
  bool recording_ = false, cut_ = false;
  static constexpr unsigned kSample = 251;
  double (*cpu_clock_)();
  unsigned exchanges_ = 0;
  double device_cpu_ = 0;

  // Carries bytes both ways until none move.
  Ticks exchange() {
    for (;;) {
      down_.clear();
      up_.clear();
      Ticks next = link_.poll(now_, down_);
      if (recording_) recorded_.insert(recorded_.end(), down_.begin(), down_.end());
      bool sampled = cpu_clock_ && exchanges_++ % kSample == 0;
      double idle = 0, before = 0;
      if (sampled) {
        cpu_clock_();  // the first call after a while takes longer than the next
        idle = cpu_clock_();
        before = cpu_clock_();
      }
      if (!down_.empty()) device_.feed(down_.data(), down_.size(), now_);
      device_.poll(now_, up_);
      // The clock's own cost, before - idle, is taken off.
      if (sampled) device_cpu_ += kSample * (cpu_clock_() - before - (before - idle));
      if (up_.empty()) return next;
      link_.feed(up_.data(), up_.size(), now_);
    }
  }
};

}  // namespace passo::wire
