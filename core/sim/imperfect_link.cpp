#include "sim/imperfect_link.hpp"

#include <algorithm>

namespace passo::wire {

Ticks Distant::host_at(Ticks clock) const {
  if (clock == kNever) return kNever;
  Ticks host = Ticks(std::ceil(double(clock - start_) / rate_));
  while (clock_at(host) < clock) ++host;
  return host;
}

void Distant::feed(const uint8_t* data, size_t n, Ticks now) {
  if (cut_) return;
  carry(down_, Bytes(data, data + n), now);
}

void Distant::poll(Ticks now, Bytes& out) {
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

Ticks Distant::next_deadline() const {
  Ticks next = host_at(device_.next_deadline());
  for (const Direction* direction : {&down_, &up_}) {
    if (!direction->flying.empty()) next = std::min(next, direction->flying.front().first);
    if (!direction->held.empty()) next = std::min(next, direction->until);
  }
  return next;
}

double Distant::random() {
  random_ = random_ * 1664525u + 1013904223u;  // as in Numerical Recipes
  return double(random_) / 4294967296.0;
}

void Distant::carry(Direction& direction, const Bytes& bytes, Ticks now) {
  if (frames_ == 0 && direction.held.empty()) return send(direction, bytes, now, 0);
  for (auto at = bytes.begin(); at != bytes.end();) {
    Bytes frame(at, at + long(frame_size(&*at, size_t(bytes.end() - at))));
    at += long(frame.size());
    Bytes held = std::exchange(direction.held, {});
    int what = random() < frames_ ? int(4 * random()) : -1;
    if (what >= 0) ++counts_[size_t(what)];
    if (what == 2 && held.empty()) {
      direction.held = std::move(frame);
      direction.until = now + kHeldTrips * (latency_ + jitter_);
      continue;
    }
    if (what == 1) {
      Bytes again = frame;
      frame.insert(frame.end(), again.begin(), again.end());
    }
    Ticks late = what == 3 ? Ticks(random() * double(kLateTrips * (latency_ + jitter_))) : 0;
    if (what != 0) send(direction, frame, now, late);
    if (!held.empty()) send(direction, held, now, 0);
  }
}

size_t Distant::frame_size(const uint8_t* data, size_t n) {
  size_t marks = 0;
  while (marks < n && data[marks] == kSync) ++marks;
  if (marks == n || data[marks] < kFrameMin || marks + data[marks] > n) return n;
  return marks + data[marks];
}

void Distant::release(Direction& direction, Ticks now) {
  if (!direction.held.empty() && direction.until <= now)
    send(direction, std::exchange(direction.held, {}), now, 0);
}

void Distant::send(Direction& direction, Bytes bytes, Ticks now, Ticks late) {
  if (spoilt_ > 0) {
    bytes = spoilt(bytes);
    auto cut = bytes.begin() + long(random() * double(bytes.size()));
    push(direction, Bytes(bytes.begin(), cut), now, late);
    bytes.erase(bytes.begin(), cut);
    late = 0;
  }
  push(direction, std::move(bytes), now, late);
}

void Distant::push(Direction& direction, Bytes bytes, Ticks now, Ticks late) {
  Ticks at = arrival(direction, now) + late;
  auto& flying = direction.flying;
  if (frames_ > 0 && !flying.empty() && flying.back().first == at)
    flying.back().second.insert(flying.back().second.end(), bytes.begin(), bytes.end());
  else
    flying.push_back({at, std::move(bytes)});
}

Bytes Distant::spoilt(const Bytes& bytes) {
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

Ticks Distant::arrival(const Direction& direction, Ticks now) {
  Ticks late = Ticks(random() * double(jitter_));
  Ticks earliest = direction.flying.empty() ? 0 : direction.flying.back().first;
  return std::max(now + latency_ + late, earliest);
}

void Distant::listen(Ticks now) {
  now_ = std::max(now_, now);
  Bytes sent;
  device_.poll(clock_at(now), sent);
  if (!sent.empty() && !cut_) carry(up_, std::move(sent), now);
}

}  // namespace passo::wire
