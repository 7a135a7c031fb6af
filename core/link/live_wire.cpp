#include "link/live_wire.hpp"

#include <algorithm>
#include <chrono>
#include <exception>
#include <mutex>
#include <utility>

namespace passo::wire {

LiveWire::LiveWire(Link& link, int fd) : link_(link), cable_(fd) {
  link_.set_live();
  thread_ = std::thread([this] { carry(); });
}

LiveWire::~LiveWire() {
  stop();
  if (timeline_) timeline_->set_wake(link_.seat(), nullptr);
}

Ticks LiveWire::now() {
  std::lock_guard lock(link_.guard());
  return clock();
}

void LiveWire::use_board_clock() {
  std::lock_guard lock(link_.guard());
  board_clock_ = true;
}

void LiveWire::join(std::shared_ptr<Timeline> timeline) {
  std::lock_guard lock(link_.guard());
  timeline_ = std::move(timeline);
  timeline_->set_wake(link_.seat(), [this] { cable_.wake(); });
}

void LiveWire::stop() {
  if (!thread_.joinable()) return;
  stopping_ = true;
  cable_.wake();
  thread_.join();
  cable_.cut();
}

Stop LiveWire::run(Ticks until, bool until_heaters) {
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

std::string LiveWire::failure() {
  std::lock_guard lock(link_.guard());
  return failure_;
}

Ticks LiveWire::clock() {
  Ticks host = monotonic_ticks(link_.hz());
  if (!board_clock_) return host;
  return last_ = std::max(last_, link_.clock().clock_at(host));
}

void LiveWire::carry() {
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

void LiveWire::carry_on() {
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

}  // namespace passo::wire
