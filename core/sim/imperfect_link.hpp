// A device whose clock and cable are not perfect.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <deque>
#include <utility>

#include "link/device.hpp"
#include "link/frame.hpp"

namespace passo::wire {

// The device's clock reads `start` when host time is 0, and is `drift` faster (a share: 1e-6 is
// 1 ppm). Bytes travel `latency` ticks of host time each way, and up to `jitter` ticks longer,
// never overtaking each other; the same on every computer.
class Distant : public Device {
 public:
  Distant(Device& device, Ticks start, double drift, Ticks latency, Ticks jitter, uint32_t seed)
      : device_(device), start_(start), rate_(1 + drift), latency_(latency), jitter_(jitter),
        random_(seed) {}

  // The device's clock at a host time, and the first host time at which it reads at least `clock`.
  Ticks clock_at(Ticks host) const { return start_ + Ticks(std::floor(double(host) * rate_)); }
  Ticks host_at(Ticks clock) const {
    if (clock == kNever) return kNever;
    Ticks host = Ticks(std::ceil(double(clock - start_) / rate_));
    while (clock_at(host) < clock) ++host;
    return host;
  }

  // Host time, as far as it has passed here.
  Ticks now() const { return now_; }
  // While it is cut, what is sent either way is lost.
  void cut(bool on) { cut_ = on; }
  // So large a share of all bytes, either way, arrives as another one, not at all, twice, before
  // the one before it, or behind one that nobody sent; and what is sent at once may arrive in two
  // parts. So large a share of all frames arrives not at all, twice, behind the next one, or late
  // and at once with what is sent meanwhile. No frame overtakes more than one: a number of four
  // bits, of which twelve may be on their way, tells no older ones.
  void spoil(double bytes, double frames) { spoilt_ = bytes, frames_ = frames; }
  // How many frames were lost, doubled, swapped and late so far.
  const std::array<int, 4>& spoilt_frames() const { return counts_; }

  void feed(const uint8_t* data, size_t n, Ticks now) override {
    if (cut_) return;
    carry(down_, Bytes(data, data + n), now);
  }
  void poll(Ticks now, Bytes& out) override {
    release(down_, now);
    for (auto& flying = down_.flying; !flying.empty() && flying.front().first <= now;) {
      Bytes& bytes = flying.front().second;
      device_.feed(bytes.data(), bytes.size(), clock_at(flying.front().first));
      listen(flying.front().first);
      flying.pop_front();
    }
    listen(now);
    release(up_, now);
    for (auto& flying = up_.flying; !flying.empty() && flying.front().first <= now;) {
      out.insert(out.end(), flying.front().second.begin(), flying.front().second.end());
      flying.pop_front();
    }
  }
  Ticks next_deadline() const override {
    Ticks next = host_at(device_.next_deadline());
    for (const Way* way : {&down_, &up_}) {
      if (!way->flying.empty()) next = std::min(next, way->flying.front().first);
      if (!way->held.empty()) next = std::min(next, way->until);
    }
    return next;
  }
  bool stopped() const override { return device_.stopped(); }

 private:
  static constexpr Ticks kHeldTrips = 8, kLateTrips = 40;  // in times of a trip
  struct Way {
    std::deque<std::pair<Ticks, Bytes>> flying;  // bytes by their time of arrival
    Bytes held;                                  // a frame that lets the next one pass
    Ticks until = 0;                             // which goes if none has come by then
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

  double random() {
    random_ = random_ * 1664525u + 1013904223u;  // as in Numerical Recipes
    return double(random_) / 4294967296.0;
  }
  void carry(Way& way, const Bytes& bytes, Ticks now) {
    if (frames_ == 0 && way.held.empty()) return send(way, bytes, now, 0);
    for (auto at = bytes.begin(); at != bytes.end();) {
      Bytes frame(at, at + long(frame_size(&*at, size_t(bytes.end() - at))));
      at += long(frame.size());
      Bytes held = std::exchange(way.held, {});
      int what = random() < frames_ ? int(4 * random()) : -1;
      if (what >= 0) ++counts_[size_t(what)];
      if (what == 2 && held.empty()) {
        way.held = std::move(frame);
        way.until = now + kHeldTrips * (latency_ + jitter_);
        continue;
      }
      if (what == 1) {
        Bytes again = frame;
        frame.insert(frame.end(), again.begin(), again.end());
      }
      Ticks late = what == 3 ? Ticks(random() * double(kLateTrips * (latency_ + jitter_))) : 0;
      if (what != 0) send(way, frame, now, late);
      if (!held.empty()) send(way, held, now, 0);
    }
  }
  // Bytes of the frame that some begin with, and of the marks before it; all if they do not.
  static size_t frame_size(const uint8_t* data, size_t n) {
    size_t marks = 0;
    while (marks < n && data[marks] == kSync) ++marks;
    if (marks == n || data[marks] < kFrameMin || marks + data[marks] > n) return n;
    return marks + data[marks];
  }
  void release(Way& way, Ticks now) {
    if (!way.held.empty() && way.until <= now) send(way, std::exchange(way.held, {}), now, 0);
  }
  void send(Way& way, Bytes bytes, Ticks now, Ticks late) {
    if (spoilt_ > 0) {
      bytes = spoilt(bytes);
      auto cut = bytes.begin() + long(random() * double(bytes.size()));
      push(way, Bytes(bytes.begin(), cut), now, late);
      bytes.erase(bytes.begin(), cut);
      late = 0;
    }
    push(way, std::move(bytes), now, late);
  }
  void push(Way& way, Bytes bytes, Ticks now, Ticks late) {
    Ticks at = arrival(way, now) + late;
    auto& flying = way.flying;
    if (frames_ > 0 && !flying.empty() && flying.back().first == at)
      flying.back().second.insert(flying.back().second.end(), bytes.begin(), bytes.end());
    else
      flying.push_back({at, std::move(bytes)});
  }
  Bytes spoilt(const Bytes& bytes) {
    Bytes out;
    for (uint8_t byte : bytes) {
      int what = random() < spoilt_ ? int(5 * random()) : -1;
      if (what == 0 || what == 4) out.push_back(uint8_t(256 * random()));
      if (what == -1 || what == 2 || what == 4) out.push_back(byte);
      if (what == 2) out.push_back(byte);
      if (what == 3) out.insert(out.end() - (out.empty() ? 0 : 1), byte);
    }
    return out;
  }
  Ticks arrival(const Way& way, Ticks now) {
    Ticks late = Ticks(random() * double(jitter_));
    Ticks earliest = way.flying.empty() ? 0 : way.flying.back().first;
    return std::max(now + latency_ + late, earliest);
  }
  void listen(Ticks now) {
    now_ = std::max(now_, now);
    Bytes said;
    device_.poll(clock_at(now), said);
    if (!said.empty() && !cut_) carry(up_, std::move(said), now);
  }
};

}  // namespace passo::wire
