// The board's clock as the host knows it: a line fitted through the answers to get_clock.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "device.hpp"

namespace passo::wire {

// A board's clock against host time: a straight line through the point (time, clock), both ticks
// from an origin.
struct ClockLine {
  Ticks origin_time = 0, origin_clock = 0;
  double time = 0, clock = 0;
  double rate = 1;  // board ticks per host tick

  double clock_at(double host) const {
    return double(origin_clock) + (clock + (host - double(origin_time) - time) * rate);
  }
  double host_at(double board) const {
    return double(origin_time) + (time + (board - double(origin_clock) - clock) / rate);
  }
};

// Host time is counted in ticks of the nominal frequency; board clocks are 64 bits, unwrapped from
// the 32 that the board sends.
//
// Exponentially weighted linear regression (decay 1/30) of clock on the time at which the question
// left, moved by half the shortest round trip: the answer was made that much later.
class ClockSync {
 public:
  explicit ClockSync(double clock_hz) : hz_(clock_hz) {}

  bool ready() const { return samples_ > 0; }

  // First sample, from the 64-bit answer to get_uptime. Times in host ticks.
  void start(Ticks clock, Ticks sent, Ticks received) {
    last_clock_ = clock;
    origin_time_ = sent;
    origin_clock_ = clock;
    mean_time_ = mean_clock_ = covariance_ = 0;
    variance_ = kFirstVarianceSeconds * kFirstVarianceSeconds * hz_ * hz_;
    covariance_ = variance_;
    spread_ = kFirstSpreadSeconds * kFirstSpreadSeconds * hz_ * hz_;
    rate_ = 1;
    shortest_trip_ = double(received - sent);
    trip_seen_ = sent;
    samples_ = 1;
  }

  // The low 32 bits of a clock that lies within 2^31 ticks of the last one known.
  Ticks unwrap(uint32_t clock) const {
    return last_clock_ + int32_t(clock - uint32_t(uint64_t(last_clock_)));
  }

  void add(uint32_t clock32, Ticks sent, Ticks received) {
    Ticks clock = unwrap(clock32);
    last_clock_ = std::max(last_clock_, clock);
    double trip = double(received - sent);
    double aged = shortest_trip_ + double(sent - trip_seen_) * kTripAging;
    if (trip < aged) {
      shortest_trip_ = trip;
      trip_seen_ = sent;
    }
    double time = double(sent - origin_time_), value = double(clock - origin_clock_);
    double off = value - (mean_clock_ + (time - mean_time_) * rate_);
    double limit = kOutlierSeconds * hz_;
    if (samples_ >= kTrusted && off * off > 25 * spread_ && off * off > limit * limit) {
      // An answer that was late by far says little; it only widens what is believed.
      spread_ = std::min(spread_ * 2, limit * limit);
      return;
    }
    double weight = std::max(kDecay, 1.0 / (samples_ + 1));
    double dt = time - mean_time_, dc = value - mean_clock_;
    mean_time_ += weight * dt;
    mean_clock_ += weight * dc;
    variance_ = (1 - weight) * (variance_ + dt * dt * weight);
    covariance_ = (1 - weight) * (covariance_ + dt * dc * weight);
    rate_ = covariance_ / variance_;
    double now_off = value - (mean_clock_ + (time - mean_time_) * rate_);
    spread_ = (1 - weight) * (spread_ + now_off * now_off * weight);
    if (samples_ < kTrusted) ++samples_;
  }

  // Board clock at a host time.
  Ticks clock_at(Ticks host) const {
    double along = (double(host - origin_time_) - mean_time_ - 0.5 * shortest_trip_) * rate_;
    return origin_clock_ + Ticks(std::floor(mean_clock_ + along + 0.5));
  }
  // Host time at which the board's clock reads `clock`.
  Ticks host_at(Ticks clock) const {
    double along = (double(clock - origin_clock_) - mean_clock_) / rate_;
    return origin_time_ + Ticks(std::ceil(mean_time_ + along + 0.5 * shortest_trip_));
  }
  ClockLine line() const {
    return {origin_time_, origin_clock_, mean_time_ + 0.5 * shortest_trip_, mean_clock_, rate_};
  }
  // Board ticks per host tick.
  double rate() const { return rate_; }
  double shortest_trip() const { return shortest_trip_; }

 private:
  static constexpr double kDecay = 1.0 / 30, kOutlierSeconds = 0.0005, kFirstVarianceSeconds = 0.05;
  static constexpr double kFirstSpreadSeconds = 0.001;
  static constexpr double kTripAging = 10e-6 / 3600;  // a short trip counts less as it grows old
  static constexpr int kTrusted = 30;

  double hz_;
  int samples_ = 0;
  Ticks origin_time_ = 0, origin_clock_ = 0, last_clock_ = 0, trip_seen_ = 0;
  double mean_time_ = 0, mean_clock_ = 0, variance_ = 0, covariance_ = 0, spread_ = 0;
  double rate_ = 1, shortest_trip_ = 0;
};

}  // namespace passo::wire
