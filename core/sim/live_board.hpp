// A simulated board in real time, at the end of a cable, for real hosts.
#pragma once
#include <atomic>
#include <mutex>
#include <thread>

#include "link/cable.hpp"
#include "link/device.hpp"

namespace passo::wire {

class LiveBoard {
 public:
  // Starts at once, with the device's clock at `start`. Until stop(), use the device only while
  // guard() is locked. The clock follows real time, but pauses while the computer does not run the
  // thread, like that of a halted chip.
  LiveBoard(Device& device, int fd, double clock_hz, Ticks start = 0)
      : device_(device), cable_(fd), hz_(clock_hz), now_(start), seen_(monotonic_ticks(clock_hz)),
        thread_([this] { serve(); }) {}
  ~LiveBoard() { stop(); }

  std::mutex& guard() { return guard_; }
  void stop();

 private:
  static constexpr double kSampleSeconds = 0.002, kStallSeconds = 0.01;

  Device& device_;
  Cable cable_;
  double hz_;
  Ticks now_, seen_;
  std::mutex guard_;
  std::atomic<bool> stopping_{false};
  std::thread thread_;

  Ticks now();
  void serve();
  void serve_on();
};

}  // namespace passo::wire
