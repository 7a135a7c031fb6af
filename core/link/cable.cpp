#include "link/cable.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <time.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>

namespace passo::wire {

Ticks monotonic_ticks(double hz) {
  timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return Ticks(double(t.tv_sec) * hz + double(t.tv_nsec) * 1e-9 * hz);
}

Cable::Cable(int fd) : fd_(fd), wake_(eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {
  fcntl(fd, F_SETFL, fcntl(fd, F_GETFL) | O_NONBLOCK);
}

Cable::~Cable() {
  cut();
  close(wake_);
}

void Cable::cut() {
  if (fd_ >= 0) close(fd_);
  fd_ = -1;
  open_ = false;
}

void Cable::write_out() {
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

const Bytes& Cable::wait(double seconds) {
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

void Cable::wake() {
  uint64_t one = 1;
  while (write(wake_, &one, sizeof one) < 0 && errno == EINTR) {
  }
}

}  // namespace passo::wire
