// One end of a cable: a file descriptor of a serial device, a pty or a socket.
#pragma once
#include <fcntl.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <time.h>
#include <unistd.h>

#include <cerrno>

#include "link/device.hpp"

namespace passo::wire {

// CLOCK_MONOTONIC, the time of the event loop too, in ticks.
inline Ticks monotonic_ticks(double hz) {
  timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return Ticks(double(t.tv_sec) * hz + double(t.tv_nsec) * 1e-9 * hz);
}

// One end of a cable: reads what has come and writes what is left, without ever waiting in either.
class Cable {
 public:
  // Owns `fd` from now on.
  explicit Cable(int fd) : fd_(fd), wake_(eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {
    fcntl(fd, F_SETFL, fcntl(fd, F_GETFL) | O_NONBLOCK);
  }
  ~Cable() {
    cut();
    close(wake_);
  }
  Cable(const Cable&) = delete;
  Cable& operator=(const Cable&) = delete;

  bool open() const { return open_; }
  void cut() {
    if (fd_ >= 0) close(fd_);
    fd_ = -1;
    open_ = false;
  }
  // Bytes to be written; the next ones are to be made only when these are gone.
  Bytes& outgoing() { return out_; }
  bool written() const { return out_.empty(); }
  void write_out() {
    while (sent_ < out_.size() && open_) {
      ssize_t n = write(fd_, out_.data() + sent_, out_.size() - sent_);
      if (n < 0 && errno == EINTR) continue;
      if (n < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) return;
      if (n == 0) return;
      if (n < 0) open_ = false;
      sent_ += n > 0 ? size_t(n) : 0;
    }
    out_.clear();
    sent_ = 0;
  }
  // Sleeps until bytes come, bytes may be written, somebody calls wake(), or for `seconds`. Returns
  // what has come.
  const Bytes& wait(double seconds) {
    pollfd fds[2] = {{fd_, short(POLLIN | (out_.empty() ? 0 : POLLOUT)), 0}, {wake_, POLLIN, 0}};
    timespec t;
    t.tv_sec = time_t(seconds);
    t.tv_nsec = long((seconds - double(t.tv_sec)) * 1e9);
    in_.clear();
    if (ppoll(fds, 2, &t, nullptr) <= 0) return in_;
    if (fds[1].revents) {
      uint64_t count;
      while (read(wake_, &count, sizeof count) > 0) {
      }
    }
    if (fds[0].revents & (POLLIN | POLLHUP | POLLERR | POLLNVAL)) {
      in_.resize(kRead);
      ssize_t n = read(fd_, in_.data(), in_.size());
      if (n == 0 || (n < 0 && errno != EAGAIN && errno != EINTR)) open_ = false;
      in_.resize(n > 0 ? size_t(n) : 0);
    }
    return in_;
  }
  // From any thread.
  void wake() {
    uint64_t one = 1;
    while (write(wake_, &one, sizeof one) < 0 && errno == EINTR) {
    }
  }

 private:
  static constexpr size_t kRead = 4096;
  int fd_, wake_;
  bool open_ = true;
  Bytes in_, out_;
  size_t sent_ = 0;
};

}  // namespace passo::wire
