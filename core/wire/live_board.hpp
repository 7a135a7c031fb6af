// A device of this process at the end of a cable, in real time: a simulated board for hosts.
#pragma once
#include <algorithm>
#include <atomic>
#include <thread>

#include "cable.hpp"
#include "device.hpp"

namespace passo::wire {

class LiveBoard {
 public:
  // Begins at once, at the device's clock 0. The device belongs to the thread until stop().
  LiveBoard(Device& device, int fd, double clock_hz)
      : device_(device), cable_(fd), hz_(clock_hz), start_(monotonic_ticks(clock_hz)),
        thread_([this] { serve(); }) {}
  ~LiveBoard() { stop(); }

  void stop() {
    if (!thread_.joinable()) return;
    stopping_ = true;
    cable_.wake();
    thread_.join();
    cable_.cut();
  }

 private:
  static constexpr double kIdleSeconds = 1;

  Device& device_;
  Cable cable_;
  double hz_;
  Ticks start_;
  std::atomic<bool> stopping_{false};
  std::thread thread_;

  Ticks now() const { return monotonic_ticks(hz_) - start_; }
  void serve() {
    while (!stopping_ && cable_.open()) {
      device_.poll(now(), cable_.outgoing());
      cable_.write_out();
      double sleep = kIdleSeconds;
      if (Ticks due = device_.next_deadline(); due != kNever)
        sleep = std::clamp(double(due - now()) / hz_, 0.0, sleep);
      const Bytes& in = cable_.wait(sleep);
      if (!in.empty()) device_.feed(in.data(), in.size(), now());
    }
    device_.poll(now(), cable_.outgoing());  // what it was still doing
  }
};

}  // namespace passo::wire
