// A device of this process at the end of a cable, in real time: a simulated board for hosts.
#pragma once
#include <atomic>
#include <mutex>
#include <thread>

#include "link/cable.hpp"
#include "link/device.hpp"

namespace passo::wire {

class LiveBoard {
 public:
  // Starts at once, at this clock of the device. Until stop(), use the device under guard() only.
  // Its clock runs with the computer's, but pauses while the computer does not schedule the thread,
  // like the clock of a halted chip.
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
