// One end of a cable: a file descriptor of a serial device, a pty or a socket.
#pragma once
#include <cstddef>

#include "link/device.hpp"

namespace passo::wire {

// CLOCK_MONOTONIC, the time of the event loop too, in ticks.
Ticks monotonic_ticks(double hz);

// One end of a cable: reads the bytes that have come and writes the rest, without ever waiting in
// either.
class Cable {
 public:
  // Owns `fd` from now on.
  explicit Cable(int fd);
  ~Cable();
  Cable(const Cable&) = delete;
  Cable& operator=(const Cable&) = delete;

  bool open() const { return open_; }
  void cut();
  // Bytes to be written; the next ones are to be made only when these are gone.
  Bytes& outgoing() { return out_; }
  bool written() const { return out_.empty(); }
  void write_out();
  // Sleeps until bytes come, bytes may be written, wake() is called, or for `seconds`. Returns the
  // received bytes.
  const Bytes& wait(double seconds);
  // From any thread.
  void wake();

 private:
  static constexpr size_t kRead = 4096;
  int fd_, wake_;
  bool open_ = true;
  Bytes in_, out_;
  size_t sent_ = 0;
};

}  // namespace passo::wire
