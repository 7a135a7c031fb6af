// A device of this process at the end of a cable, in real time: a simulated board for hosts.
#pragma once
#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>

#include "link/cable.hpp"
#include "link/device.hpp"

namespace passo::wire {

class LiveBoard {
 public:
  // Begins at once, at this clock of the device. Until stop() the device is used under guard()
  // only. Its clock runs with the computer's, but stands still while the computer does not let it
  // run, as that of a chip would which is stopped.
  LiveBoard(Device& device, int fd, double clock_hz, Ticks start = 0)
      : device_(device), cable_(fd), hz_(clock_hz), now_(start), seen_(monotonic_ticks(clock_hz)),
        thread_([this] { serve(); }) {}
  ~LiveBoard() { stop(); }

  std::mutex& guard() { return guard_; }
  void stop() {
    if (!thread_.joinable()) return;
    stopping_ = true;
    cable_.wake();
    thread_.join();
    cable_.cut();
  }

 private:
  static constexpr double kLookSeconds = 0.002, kStallSeconds = 0.01;

  Device& device_;
  Cable cable_;
  double hz_;
  Ticks now_, seen_;
  std::mutex guard_;
  std::atomic<bool> stopping_{false};
  std::thread thread_;

  Ticks now() {
    Ticks before = std::exchange(seen_, monotonic_ticks(hz_));
    return now_ += std::min(seen_ - before, Ticks(kStallSeconds * hz_));
  }
  void serve() {
    try {
      serve_on();
    } catch (const std::exception&) {  // of a simulated part: this board is silent from now on
      cable_.cut();
    }
  }
  void serve_on() {
    while (!stopping_ && cable_.open()) {
      double sleep = kLookSeconds;
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
    device_.poll(now(), cable_.outgoing());  // what it was still doing
  }
};

}  // namespace passo::wire
