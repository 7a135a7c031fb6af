#include "sim/live_board.hpp"

#include <algorithm>
#include <exception>
#include <utility>

namespace passo::wire {

void LiveBoard::stop() {
  if (!thread_.joinable()) return;
  stopping_ = true;
  cable_.wake();
  thread_.join();
  cable_.cut();
}

Ticks LiveBoard::now() {
  Ticks before = std::exchange(seen_, monotonic_ticks(hz_));
  return now_ += std::min(seen_ - before, Ticks(kStallSeconds * hz_));
}

void LiveBoard::serve() {
  try {
    serve_on();
  } catch (const std::exception&) {  // from a simulated part: this board stays silent from now on
    cable_.cut();
  }
}

void LiveBoard::serve_on() {
  while (!stopping_ && cable_.open()) {
    double sleep = kSampleSeconds;
    {
      std::lock_guard lock(guard_);
      device_.poll(now(), cable_.outgoing());
      if (Ticks due = device_.next_deadline(); due != kNever)
        sleep = std::clamp(double(due - now_) / hz_, 0.0, sleep);
    }
    cable_.write_out();
    const Bytes& in = cable_.wait(sleep);
    std::lock_guard lock(guard_);
    if (!in.empty()) device_.feed(in.data(), in.size(), now());
  }
  std::lock_guard lock(guard_);
  device_.poll(now(), cable_.outgoing());  // finishes its work
}

}  // namespace passo::wire
