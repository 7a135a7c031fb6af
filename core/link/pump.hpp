// Links and devices in one process, in virtual time: from deadline to deadline, as fast as it goes.
#pragma once
#include <algorithm>
#include <cmath>
#include <vector>

#include "link/device.hpp"
#include "link/link.hpp"
#include "link/stop_reason.hpp"

namespace passo::wire {

class Pump {
 public:
  // Host time equals the first device's clock and begins at `start`.
  // `cpu_clock` gives CPU seconds, or is null.
  Pump(Link& link, Device& device, Ticks start, double (*cpu_clock)() = nullptr)
      : now_(start), cpu_clock_(cpu_clock) {
    attach(link, device);
  }
  // A further device, or another link to one that is here already. The device's clock is host time,
  // in ticks of the link's frequency.
  void attach(Link& link, Device& device) {
    for (End& end : ends_)
      if (end.device == &device) {
        end.link = &link;
        return;
      }
    ends_.push_back({&link, &device, ends_.empty() ? 1 : link.hz() / ends_[0].link->hz(), {}, {}});
  }

  Ticks now() const { return now_; }
  double hz() const { return ends_[0].link->hz(); }
  // The clock of a link's board, as far as that knows it.
  Ticks board_clock(const Link& link) const {
    for (const End& end : ends_)
      if (end.link == &link && link.synchronous()) return link.clock().clock_at(end.own(now_));
    return now_;
  }
  // The cables are cut: no byte arrives any more.
  void cut() { cut_ = true; }
  // This host does nothing until then, and the boards live on.
  void sleep(Ticks until) {
    now_ = std::max(now_, until);
    for (End& end : ends_) end.device->poll(end.own(now_), end.up);
  }
  // The part of run()'s work that is the devices', from a sample of one exchange in kSample.
  double device_share() const {
    return device_cpu_ > 0 ? device_cpu_ / (device_cpu_ + link_cpu_) : 0;
  }
  // Bytes that the host sent to the first board, frames and all, from now on.
  void record(bool on) {
    recording_ = on;
    recorded_.clear();
  }
  Bytes& recorded() { return recorded_; }

  // Runs until virtual time reaches `until`, until all boards have stopped, or one for so long that
  // the others should have heard of it, until a heater fails, or, if asked,
  // until no heater is on its way to its target. The queue of the job must already hold all
  // messages whose clock is below `until` plus the horizon.
  Stop run(Ticks until, bool until_heaters) {
    for (Ticks told = kNever;;) {
      if (cut_) return Stop::closed;
      Ticks next = exchange();
      bool any_stopped = false, all_stopped = true, fault = false, reached = until_heaters;
      for (End& end : ends_) {
        next = std::min(next, end.host(end.device->next_deadline()));
        any_stopped |= end.link->shut_down();
        all_stopped = all_stopped && end.link->shut_down();
        fault |= end.link->take_fault();
        reached = reached && end.link->heaters_reached();
      }
      if (any_stopped) {
        told = std::min(told, now_ + Ticks(kNewsSeconds * ends_[0].link->hz()));
        if (all_stopped || now_ >= told) return Stop::shutdown;
        next = std::min(next, told);
      }
      if (fault) return Stop::fault;
      if (reached) return Stop::heaters;
      if (next > until && !any_stopped) {
        now_ = std::max(now_, until);
        // Nothing is due, but they learn the time.
        for (End& end : ends_) end.device->poll(end.own(now_), end.up);
        return Stop::time;
      }
      now_ = std::max(next, now_);
    }
  }

 private:
  struct End {
    Link* link;
    Device* device;
    double ratio;  // its ticks per tick of the first one
    Bytes down, up;

    Ticks own(Ticks host) const { return ratio == 1 ? host : Ticks(double(host) * ratio); }
    Ticks host(Ticks own) const {
      return ratio == 1 || own == kNever ? own : Ticks(std::ceil(double(own) / ratio));
    }
  };
  std::vector<End> ends_;
  Ticks now_;
  Bytes recorded_;
  bool recording_ = false, cut_ = false;
  static constexpr unsigned kSample = 101;
  static constexpr double kNewsSeconds = 0.05;
  double (*cpu_clock_)();
  unsigned exchanges_ = 0;
  double device_cpu_ = 0, link_cpu_ = 0;

  // Carries bytes until none move: what one link has heard another may have to tell its board.
  // Returns the links' next deadline.
  Ticks exchange() {
    for (;;) {
      Ticks next = kNever;
      bool moved = false;
      for (End& end : ends_) next = std::min(next, end.host(exchange(end, moved)));
      if (!moved || ends_.size() == 1) return next;
    }
  }
  Ticks exchange(End& end, bool& moved) {
    const Ticks now = end.own(now_);
    for (;;) {
      bool sampled = cpu_clock_ && exchanges_++ % kSample == 0;
      if (sampled) cpu_clock_();  // the first call after a while takes longer than the next
      double begun = clock(sampled), asked = clock(sampled);
      end.down.clear();
      Ticks next = end.link->poll(now, end.down);
      if (recording_ && &end == &ends_[0])
        recorded_.insert(recorded_.end(), end.down.begin(), end.down.end());
      double sent = clock(sampled);
      if (!end.down.empty()) end.device->feed(end.down.data(), end.down.size(), now);
      end.device->poll(now, end.up);
      double answered = clock(sampled);
      const bool heard = !end.up.empty();
      moved |= !end.down.empty() || heard;
      const bool again = heard && end.link->feed(end.up.data(), end.up.size(), now);
      end.up.clear();
      if (sampled) {
        double reading = asked - begun;  // what the clock itself takes
        device_cpu_ += answered - sent - reading;
        link_cpu_ += sent - asked + clock(true) - answered - 2 * reading;
      }
      if (!again) return next;
    }
  }
  double clock(bool sampled) const { return sampled ? cpu_clock_() : 0; }
};

}  // namespace passo::wire
