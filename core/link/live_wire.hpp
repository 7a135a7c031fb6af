// A link on a cable, in real time: a thread of its own carries the bytes, so whatever else the
// program does, commands leave when they are due and heaters are looked after.
#pragma once
#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <utility>

#include "link/cable.hpp"
#include "link/link.hpp"
#include "link/stop_reason.hpp"

namespace passo::wire {

class LiveWire {
 public:
  // Begins at once. The link may be used from other threads under its guard() only, and must
  // outlive this; the queue of its job is shared from now on.
  LiveWire(Link& link, int fd) : link_(link), cable_(fd) {
    link_.set_live();
    thread_ = std::thread([this] { carry(); });
  }
  ~LiveWire() {
    stop();
    if (timeline_) timeline_->set_wake(link_.seat(), nullptr);
  }

  double hz() const { return link_.hz(); }
  // This computer's time in ticks, and from use_board_clock() on the board's clock, which never
  // runs backwards.
  Ticks now() {
    std::lock_guard lock(link_.guard());
    return clock();
  }
  // Once the link is synchronous: not by itself, lest the time change while somebody reckons with
  // it.
  void use_board_clock() {
    std::lock_guard lock(link_.guard());
    board_clock_ = true;
  }
  // The link looks up whenever others of its machine have news for it.
  void join(std::shared_ptr<Timeline> timeline) {
    std::lock_guard lock(link_.guard());
    timeline_ = std::move(timeline);
    timeline_->set_wake(link_.seat(), [this] { cable_.wake(); });
  }
  // No byte moves any more, and the cable is let go.
  void stop() {
    if (!thread_.joinable()) return;
    stopping_ = true;
    cable_.wake();
    thread_.join();
    cable_.cut();
  }
  // As Pump::run, but real time passes; also ends when the cable is cut.
  Stop run(Ticks until, bool until_heaters) {
    cable_.wake();  // there may be commands to send
    std::unique_lock lock(link_.guard());
    Ticks end = monotonic_ticks(link_.hz()) + (until - clock());
    for (;;) {
      if (link_.shut_down()) return Stop::shutdown;
      if (closed_) return Stop::closed;
      if (link_.take_fault()) return Stop::fault;
      if (until_heaters && link_.heaters_reached()) return Stop::heaters;
      double left = double(end - monotonic_ticks(link_.hz())) / link_.hz();
      if (left <= 0) return Stop::time;
      news_.wait_for(lock, std::chrono::duration<double>(left));
    }
  }
  // What ended the connection, if it was not the cable; empty if it was, or while it lasts.
  std::string failure() {
    std::lock_guard lock(link_.guard());
    return failure_;
  }

 private:
  static constexpr double kIdleSeconds = 0.01;  // planned messages come without a call

  Link& link_;
  Cable cable_;
  std::shared_ptr<Timeline> timeline_;
  std::condition_variable news_;
  bool closed_ = false, board_clock_ = false;
  Ticks last_ = 0;
  std::string failure_;
  std::atomic<bool> stopping_{false};
  std::thread thread_;

  Ticks clock() {
    Ticks host = monotonic_ticks(link_.hz());
    if (!board_clock_) return host;
    return last_ = std::max(last_, link_.clock().clock_at(host));
  }

  void carry() {
    std::string failure;
    try {
      carry_on();
    } catch (const std::exception& e) {  // of a board that does not keep to its own dictionary
      failure = e.what();
    }
    std::lock_guard lock(link_.guard());
    failure_ = std::move(failure);
    closed_ = true;
    if (timeline_ && !stopping_) timeline_->lost();
    news_.notify_all();
  }
  void carry_on() {
    const double hz = link_.hz();
    while (!stopping_ && cable_.open()) {
      Ticks now = monotonic_ticks(hz), due = kNever;
      {
        std::lock_guard lock(link_.guard());
        if (cable_.written())
          due = link_.poll(now, cable_.outgoing());
        else
          link_.cable_full(now);
      }
      cable_.write_out();
      double sleep = kIdleSeconds;
      if (due != kNever) sleep = std::clamp(double(due - monotonic_ticks(hz)) / hz, 0.0, sleep);
      const Bytes& in = cable_.wait(sleep);
      Ticks after = monotonic_ticks(hz);
      std::lock_guard lock(link_.guard());
      if (!in.empty()) link_.feed(in.data(), in.size(), after);
      closed_ = !cable_.open();
      news_.notify_all();
    }
  }
};

}  // namespace passo::wire
