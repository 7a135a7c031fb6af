// One end of a cable: a file descriptor of a serial device, a pty or a socket.
#pragma once
#include <cstddef>

#include "link/device.hpp"

namespace passo::wire {

// CLOCK_MONOTONIC in ticks: also the time of the event loop.
Ticks monotonic_ticks(double hz);

// One end of a cable: reads received bytes and writes pending ones without blocking.
class Cable {
 public:
  // Owns `fd` from now on.
  explicit Cable(int fd);
  ~Cable();
  Cable(const Cable&) = delete;
  Cable& operator=(const Cable&) = delete;

  bool open() const { return open_; }
  void cut();
  // Bytes to be written. Produce the next ones only when this is empty.
  Bytes& outgoing() { return out_; }
  bool written() const { return out_.empty(); }
  void write_out();
  // Sleeps until bytes arrive, bytes may be written, wake() is called, or `seconds` have passed.
  // Returns the received bytes.
  const Bytes& wait(double seconds);
  // May be called from any thread.
  void wake();

 private:
  static constexpr size_t kRead = 4096;
  int fd_, wake_;
  bool open_ = true;
  Bytes in_, out_;
  size_t sent_ = 0;
};

}  // namespace passo::wire
