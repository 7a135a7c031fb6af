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
// Weighted linear regression of the clock on the middle of the time between question and answer,
// which forgets in kMemorySeconds. The middle is wrong by half at most of what a trip takes longer
// than the shortest one, so that quick answers count most and late ones next to nothing: the clock
// filter of NTP (Mills, RFC 5905), with weights in place of a choice.
class ClockSync {
 public:
  explicit ClockSync(double clock_hz) : hz_(clock_hz) {}

  bool ready() const { return ready_; }

  // First sample, from the 64-bit answer to get_uptime. Times in host ticks.
  void start(Ticks clock, Ticks sent, Ticks received) {
    ready_ = true;
    last_clock_ = clock;
    origin_time_ = sent;
    origin_clock_ = clock;
    mean_time_ = last_time_ = 0.5 * double(received - sent);
    mean_clock_ = 0;
    // Crystals are good to some parts in a million before anything is known.
    variance_ = covariance_ = kFirstSpreadSeconds * kFirstSpreadSeconds * hz_ * hz_;
    rate_ = 1;
    weights_ = 1;
    shortest_trip_ = double(received - sent);
    usual_excess_ = 0;
  }

  // The board was not asked for a while, until this host time.
  void bridge(Ticks host) {
    if (ready_) last_clock_ = std::max(last_clock_, clock_at(host));
  }
  // The low 32 bits of a clock that lies within 2^31 ticks of the last one known.
  Ticks unwrap(uint32_t clock) const {
    return last_clock_ + int32_t(clock - uint32_t(uint64_t(last_clock_)));
  }

  void add(uint32_t clock32, Ticks sent, Ticks received) {
    Ticks clock = unwrap(clock32);
    last_clock_ = std::max(last_clock_, clock);
    double trip = double(received - sent);
    double time = double(sent - origin_time_) + 0.5 * trip, value = double(clock - origin_clock_);
    double passed = std::max(time - last_time_, 0.0) / hz_;
    last_time_ = time;
    // What was once the shortest may be out of reach by now.
    shortest_trip_ = std::min(trip, shortest_trip_ + passed * kTripAging * hz_);
    double excess = trip - shortest_trip_;
    usual_excess_ += (excess - usual_excess_) * kExcessGain;
    double good = std::max(kGoodSeconds * hz_, kGoodShare * usual_excess_);
    double weight = 1 / (1 + (excess / good) * (excess / good));

    double kept = 1 / (1 + passed / kMemorySeconds);
    weights_ *= kept;
    double before = weights_;
    weights_ += weight;
    double share = weight / weights_, moment = before * share;
    double dt = time - mean_time_, dc = value - mean_clock_;
    mean_time_ += share * dt;
    mean_clock_ += share * dc;
    variance_ = kept * variance_ + moment * dt * dt;
    covariance_ = kept * covariance_ + moment * dt * dc;
    rate_ = covariance_ / variance_;
  }

  ClockLine line() const { return {origin_time_, origin_clock_, mean_time_, mean_clock_, rate_}; }
  // Board clock at a host time.
  Ticks clock_at(Ticks host) const {
    double along = (double(host - origin_time_) - mean_time_) * rate_;
    return origin_clock_ + Ticks(std::floor(mean_clock_ + along + 0.5));
  }
  // Host time at which the board's clock reads `clock`.
  Ticks host_at(Ticks clock) const {
    double along = (double(clock - origin_clock_) - mean_clock_) / rate_;
    return origin_time_ + Ticks(std::ceil(mean_time_ + along));
  }
  // Board ticks per host tick.
  double rate() const { return rate_; }

 private:
  static constexpr double kMemorySeconds = 20, kFirstSpreadSeconds = 0.02;
  static constexpr double kTripAging = 1e-6;  // seconds in each second
  static constexpr double kGoodSeconds = 2e-6, kGoodShare = 0.25, kExcessGain = 1.0 / 16;

  double hz_;
  bool ready_ = false;
  Ticks origin_time_ = 0, origin_clock_ = 0, last_clock_ = 0;
  double mean_time_ = 0, mean_clock_ = 0, last_time_ = 0;
  double variance_ = 0, covariance_ = 0, weights_ = 0;
  double rate_ = 1, shortest_trip_ = 0, usual_excess_ = 0;
};

}  // namespace passo::wire
