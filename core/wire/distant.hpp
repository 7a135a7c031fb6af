// A device whose clock and cable are not perfect.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <deque>
#include <utility>

#include "device.hpp"

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
  // parts.
  void spoil(double share) { spoilt_ = share; }

  void feed(const uint8_t* data, size_t n, Ticks now) override {
    if (cut_) return;
    carry(down_, Bytes(data, data + n), now);
  }
  void poll(Ticks now, Bytes& out) override {
    while (!down_.empty() && down_.front().first <= now) {
      Bytes& bytes = down_.front().second;
      device_.feed(bytes.data(), bytes.size(), clock_at(down_.front().first));
      listen(down_.front().first);
      down_.pop_front();
    }
    listen(now);
    for (; !up_.empty() && up_.front().first <= now; up_.pop_front())
      out.insert(out.end(), up_.front().second.begin(), up_.front().second.end());
  }
  Ticks next_deadline() const override {
    Ticks next = host_at(device_.next_deadline());
    if (!down_.empty()) next = std::min(next, down_.front().first);
    if (!up_.empty()) next = std::min(next, up_.front().first);
    return next;
  }
  bool stopped() const override { return device_.stopped(); }

 private:
  using Way = std::deque<std::pair<Ticks, Bytes>>;  // bytes by their time of arrival
  Device& device_;
  Ticks start_;
  double rate_;
  Ticks latency_, jitter_, now_ = 0;
  uint32_t random_;
  double spoilt_ = 0;
  bool cut_ = false;
  Way down_, up_;

  double random() {
    random_ = random_ * 1664525u + 1013904223u;  // as in Numerical Recipes
    return double(random_) / 4294967296.0;
  }
  void carry(Way& way, Bytes bytes, Ticks now) {
    if (spoilt_ > 0) {
      bytes = spoilt(bytes);
      auto cut = bytes.begin() + long(random() * double(bytes.size()));
      way.push_back({arrival(way, now), Bytes(bytes.begin(), cut)});
      bytes.erase(bytes.begin(), cut);
    }
    way.push_back({arrival(way, now), std::move(bytes)});
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
    Ticks earliest = way.empty() ? 0 : way.back().first;
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
