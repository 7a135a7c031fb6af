#include "link/send_window.hpp"

#include <algorithm>
#include <utility>

namespace passo::wire {

void Window::restart() {
  acked_ = last_ack_ = next_;
  bytes_ = 0;
  synchronous_ = resend_ = measured_ = false;
  silent_ = 0;
  doubtful_ = kNever;
  line_free_ = 0;
  rto_ = rto_start_;
  urgent_ = 0;
}

void Window::seal(size_t payload, Ticks now, Bytes& out) {
  Block& b = block(next_);
  b.length = uint8_t(seal_frame(b.data, payload, next_));
  b.sent = now;
  b.gone = on_the_line(b.length, now);
  b.again = b.opening = !synchronous_;
  if (idle()) deadline_ = b.gone + rto_;
  bytes_ += b.length;
  ++next_;
  out.insert(out.end(), b.data, b.data + b.length);
}

bool Window::replace(const Bytes& payload) {
  const bool whole = synchronous_ || idle();
  if (whole && next_ - acked_ <= kBlocks) block(next_++).length = 0;
  for (uint64_t i = acked_; i < next_; ++i) {
    Block& b = block(i);
    std::copy(payload.begin(), payload.end(), b.data + kHeader);
    bytes_ -= b.length;
    bytes_ += b.length = uint8_t(seal_frame(b.data, payload.size(), i));
  }
  resend_ |= urgent_ != next_;
  urgent_ = next_;
  return whole;
}

bool Window::acknowledge(uint8_t sequence, bool empty, Ticks now) {
  uint64_t number = acked_ + ((sequence - acked_) & kSequenceMask);
  if (!synchronous_) {
    if (idle()) return true;
    synchronous_ = true;
    if (number != next_) {  // the board may count from any number: its answer gives the first one
      renumber(number);
      return true;
    }
  }
  if (number > next_) return false;
  silent_ = 0;
  rto_ = measured_ ? base_ : rto_start_;
  if (number > acked_) {
    const Block& last = block(number - 1);
    Ticks trip = std::max<Ticks>(now - last.gone, 0);
    bool usual = measured_ && now - copied_ <= smooth_ + 4 * variation_ + rto_min_ / kUsualShare;
    doubtful_ = last.again && !usual ? trip : kNever;
    apart_ = now + rto_min_ / kApartShare;
    if (!last.again) measure(trip);
    for (; acked_ < number; ++acked_) bytes_ -= block(acked_).length;
    deadline_ = std::max(now, idle() ? now : block(acked_).gone) + patience();
  } else if (empty && doubtful_ != kNever && number <= ignored_ && now >= apart_) {
    measure(std::exchange(doubtful_, kNever));
  }
  if (!empty) return true;
  if (number > last_ack_) {
    last_ack_ = number;
  } else if (!idle() && number > ignored_) {
    resend_ = true;
  }
  return true;
}

void Window::poll(Ticks now, Bytes& out) {
  if (idle()) return;
  bool late = now >= deadline_;
  if (!late && !resend_) return;
  if (late && (!measured_ || ++silent_ > kSteady)) rto_ = std::min(rto_ * 2, rto_max_);
  resend_ = false;
  // Copies of frames that did arrive will be refused: those refusals are ignored.
  ignored_ = next_;
  size_t before = out.size();
  out.push_back(kSync);
  for (uint64_t i = acked_; i < next_; ++i) {
    Block& b = block(i);
    b.again = true;
    out.insert(out.end(), b.data, b.data + b.length);
  }
  retransmitted_bytes_ += out.size() - before;
  copied_ = on_the_line(out.size() - before, now);
  deadline_ = copied_ + patience();
}

bool Window::repeated(uint64_t number) const {
  return number + kSequenceMask < next_ || blocks_[number & kSequenceMask].again;
}

Ticks Window::on_the_line(size_t bytes, Ticks now) {
  return line_free_ = std::max(line_free_, now) + Ticks(byte_ticks_ * double(bytes));
}

void Window::renumber(uint64_t number) {
  Block only = block(acked_);
  size_t payload = only.length - kFrameMin;
  number += kSequenceMask + 1;  // above all numbers used so far
  only.length = uint8_t(seal_frame(only.data, payload, number));
  acked_ = last_ack_ = number;
  next_ = number + 1;
  block(number) = only;
  resend_ = true;
}

void Window::measure(Ticks trip) {
  if (!measured_) {
    measured_ = true;
    smooth_ = trip;
    variation_ = trip / 2;
  } else {
    Ticks error = trip > smooth_ ? trip - smooth_ : smooth_ - trip;
    variation_ += (error - variation_) / 4;
    smooth_ += (trip - smooth_) / 8;
  }
  rto_ = base_ = std::clamp(smooth_ + 4 * variation_, rto_min_, rto_max_);
}

}  // namespace passo::wire
