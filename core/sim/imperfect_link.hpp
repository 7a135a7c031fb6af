// A device with an inaccurate clock and a disturbed cable.
#pragma once
#include <array>
#include <cmath>
#include <cstdint>
#include <deque>
#include <utility>

#include "link/device.hpp"
#include "link/frame.hpp"

namespace passo::wire {

// The device's clock reads `start` at host time 0, and runs faster by the fraction `drift` (1e-6 is
// 1 ppm). Bytes take `latency` ticks of host time in each direction, plus a random time up to
// `jitter`. They do not overtake each other. The random numbers are the same on every computer.
class Distant : public Device {
 public:
  Distant(Device& device, Ticks start, double drift, Ticks latency, Ticks jitter, uint32_t seed)
      : device_(device), start_(start), rate_(1 + drift), latency_(latency), jitter_(jitter),
        random_(seed) {}

  // The device's clock at a host time. host_at(): the first host time at which the device's clock
  // reads at least `clock`.
  Ticks clock_at(Ticks host) const { return start_ + Ticks(std::floor(double(host) * rate_)); }
  Ticks host_at(Ticks clock) const;

  // Latest host time that was simulated.
  Ticks now() const { return now_; }
  // While the link is cut, bytes in both directions are lost.
  void cut(bool on) { cut_ = on; }
  // Damages the fraction `bytes` of all bytes in both directions: a byte is changed, lost, doubled,
  // swapped with the one before, or follows a random byte. Bytes that are sent together may arrive
  // in two parts. Also damages the fraction `frames` of all frames: a frame is lost, doubled,
  // swapped with the next one, or late together with the frames after it. A frame overtakes at most
  // one other frame: sequence numbers have four bits and up to twelve frames may be in transit, so
  // an older frame could be mistaken for a new one.
  void spoil(double bytes, double frames) { spoilt_ = bytes, frames_ = frames; }
  // Number of frames that were lost, doubled, swapped and late so far.
  const std::array<int, 4>& spoilt_frames() const { return counts_; }

  void feed(const uint8_t* data, size_t n, Ticks now) override;
  void poll(Ticks now, Bytes& out) override;
  Ticks next_deadline() const override;
  bool stopped() const override { return device_.stopped(); }

 private:
  static constexpr Ticks kHeldTrips = 8, kLateTrips = 40;  // multiples of latency + jitter
  struct Direction {
    std::deque<std::pair<Ticks, Bytes>> flying;  // bytes with their time of arrival
    Bytes held;                                  // a frame that is sent after the next one
    Ticks until = 0;                             // latest time at which the held frame is sent
  };
  Device& device_;
  Ticks start_;
  double rate_;
  Ticks latency_, jitter_, now_ = 0;
  uint32_t random_;
  double spoilt_ = 0, frames_ = 0;
  std::array<int, 4> counts_{};
  bool cut_ = false;
  Direction down_, up_;

  double random();
  void carry(Direction& direction, const Bytes& bytes, Ticks now);
  // Length of the first frame including the sync bytes before it; n if the data does not start with
  // a frame.
  static size_t frame_size(const uint8_t* data, size_t n);
  void release(Direction& direction, Ticks now);
  void send(Direction& direction, Bytes bytes, Ticks now, Ticks late);
  void push(Direction& direction, Bytes bytes, Ticks now, Ticks late);
  Bytes spoilt(const Bytes& bytes);
  Ticks arrival(const Direction& direction, Ticks now);
  void listen(Ticks now);
};

}  // namespace passo::wire
