// A device whose clock and cable are not perfect.
#pragma once
#include <array>
#include <cmath>
#include <cstdint>
#include <deque>
#include <utility>

#include "link/device.hpp"
#include "link/frame.hpp"

namespace passo::wire {

// The device's clock reads `start` when host time is 0, and is `drift` faster (a fraction: 1e-6 is
// 1 ppm). Bytes travel `latency` ticks of host time each way, and up to `jitter` ticks longer,
// never overtaking each other; the same on every computer.
class Distant : public Device {
 public:
  Distant(Device& device, Ticks start, double drift, Ticks latency, Ticks jitter, uint32_t seed)
      : device_(device), start_(start), rate_(1 + drift), latency_(latency), jitter_(jitter),
        random_(seed) {}

  // The device's clock at a host time, and the first host time at which it reads at least `clock`.
  Ticks clock_at(Ticks host) const { return start_ + Ticks(std::floor(double(host) * rate_)); }
  Ticks host_at(Ticks clock) const;

  // Host time, as far as it has passed here.
  Ticks now() const { return now_; }
  // While it is cut, bytes in both directions are lost.
  void cut(bool on) { cut_ = on; }
  // Damages this fraction of all bytes in both directions: a byte is changed, lost, doubled,
  // swapped with the one before, or preceded by a random one; bytes sent together may arrive in two
  // parts. Damages this fraction of all frames: a frame is lost, doubled, swapped with the next
  // one, or arrives late, together with later ones. A frame overtakes at most one other: its number
  // has four bits and twelve frames may be on their way, so older frames could not be recognised.
  void spoil(double bytes, double frames) { spoilt_ = bytes, frames_ = frames; }
  // How many frames were lost, doubled, swapped and late so far.
  const std::array<int, 4>& spoilt_frames() const { return counts_; }

  void feed(const uint8_t* data, size_t n, Ticks now) override;
  void poll(Ticks now, Bytes& out) override;
  Ticks next_deadline() const override;
  bool stopped() const override { return device_.stopped(); }

 private:
  static constexpr Ticks kHeldTrips = 8, kLateTrips = 40;  // in times of a trip
  struct Way {
    std::deque<std::pair<Ticks, Bytes>> flying;  // bytes by their time of arrival
    Bytes held;                                  // a frame that is delivered after the next one
    Ticks until = 0;                             // when the held frame is delivered if no other
                                                 // frame has followed
  };
  Device& device_;
  Ticks start_;
  double rate_;
  Ticks latency_, jitter_, now_ = 0;
  uint32_t random_;
  double spoilt_ = 0, frames_ = 0;
  std::array<int, 4> counts_{};
  bool cut_ = false;
  Way down_, up_;

  double random();
  void carry(Way& way, const Bytes& bytes, Ticks now);
  // Bytes of the frame that some begin with, and of the marks before it; all if they do not.
  static size_t frame_size(const uint8_t* data, size_t n);
  void release(Way& way, Ticks now);
  void send(Way& way, Bytes bytes, Ticks now, Ticks late);
  void push(Way& way, Bytes bytes, Ticks now, Ticks late);
  Bytes spoilt(const Bytes& bytes);
  Ticks arrival(const Way& way, Ticks now);
  void listen(Ticks now);
};

}  // namespace passo::wire
