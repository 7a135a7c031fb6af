// The board's clock as the host knows it: a line between what the answers to get_clock allow.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <deque>
#include <limits>

#include "link/device.hpp"

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
// A question is read after it was sent, and an answer heard after it was made: each bounds the line
// from one side. Where nothing was delayed much both bounds are tight, and the line lies in the
// middle of the corridor between them at the rate at which that is widest: what is delayed touches
// no bound, and the error falls with the number of answers, not with its root. (Delays of two ways
// by hulls: Moon, Skelly, Towsley, "Estimation and removal of clock skew from network delay
// measurements", INFOCOM 1999.) The least delays of both ways are taken to be equal.
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
    rate_ = prior_ = 1;
    usual_excess_ = last_time_ = 0;
    shortest_trip_ = double(received - sent);
    spans_.clear();
    take(0, shortest_trip_, 0);
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
    // No clock goes back, but that of a host that slept stood still.
    if (clock < last_clock_ - Ticks(hz_)) clock += Ticks(1) << 32;
    last_clock_ = std::max(last_clock_, clock);
    const double trip = double(received - sent), asked = double(sent - origin_time_);
    // What was once the shortest may be out of reach by now.
    double passed = std::max(asked - last_time_, 0.0);
    shortest_trip_ = std::min(trip, shortest_trip_ + passed * kTripAging);
    usual_excess_ += (trip - shortest_trip_ - usual_excess_) * kExcessGain;
    take(asked, asked + trip, double(clock - origin_clock_));
  }

  // What an answer usually takes longer than the quickest ones, seconds.
  double jitter_s() const { return usual_excess_ / hz_; }
  ClockLine line() const { return {origin_time_, origin_clock_, last_time_, value_, rate_}; }
  // Board clock at a host time.
  Ticks clock_at(Ticks host) const {
    double along = (double(host - origin_time_) - last_time_) * rate_;
    return origin_clock_ + Ticks(std::floor(value_ + along + 0.5));
  }
  // Host time at which the board's clock reads `clock`.
  Ticks host_at(Ticks clock) const {
    double along = (double(clock - origin_clock_) - value_) / rate_;
    return origin_time_ + Ticks(std::ceil(last_time_ + along));
  }
  // Board ticks per host tick.
  double rate() const { return rate_; }

 private:
  static constexpr double kTripAging = 1e-6;  // seconds in each second
  static constexpr double kExcessGain = 1.0 / 16;
  static constexpr double kMemorySeconds = 40, kSpanSeconds = 0.15;
  static constexpr double kRateRange = 0.01;  // of the worst resonators, either way
  // A rate must widen the corridor by so many seconds for each unit by which it differs from what
  // was known before: a short while tells nothing of it. Least of all one span, in which nothing
  // bounds the rate, since what was read and what was heard may be as far apart as it is long.
  static constexpr double kPriorSeconds = 0.2;
  static_assert(kSpanSeconds < kPriorSeconds);
  static constexpr double kJumpSeconds = 0.5e-3;  // so narrow no corridor is: a clock has jumped
  static constexpr int kMostTangents = 64;        // usually four to eight are enough
  static constexpr double kFineTicks = 1e-4;      // rounding is less, and does not matter more

  struct Point {
    double time, clock;  // since the origin
  };
  // The tightest bounds of a while: what was read soonest, and what was heard soonest.
  struct Span {
    double begin;
    Point read, heard;
  };

  double hz_;
  bool ready_ = false;
  Ticks origin_time_ = 0, origin_clock_ = 0, last_clock_ = 0;
  std::deque<Span> spans_;
  double last_time_ = 0, value_ = 0;  // the line goes through this point
  double rate_ = 1, prior_ = 1, shortest_trip_ = 0, usual_excess_ = 0;

  void take(double asked, double heard, double clock) {
    const Span now{asked, {asked, clock}, {heard, clock}};
    while (!spans_.empty() && spans_.front().begin < asked - kMemorySeconds * hz_)
      spans_.pop_front();
    if (spans_.empty()) prior_ = rate_;
    if (spans_.empty() || asked >= spans_.back().begin + kSpanSeconds * hz_) {
      spans_.push_back(now);
    } else {
      Span& last = spans_.back();
      auto offset = [this](const Point& p) { return p.clock - p.time * rate_; };
      if (offset(now.read) < offset(last.read)) last.read = now.read;
      if (offset(now.heard) > offset(last.heard)) last.heard = now.heard;
    }
    last_time_ = asked;
    find_rate();
    Corridor c = corridor(rate_);
    if (c.upper - c.lower < -kJumpSeconds * hz_) {
      spans_.assign(1, now);
      prior_ = rate_;
      c = corridor(rate_);
    }
    value_ = 0.5 * (c.upper + c.lower);
  }
  // The corridor at a rate: its bounds at last_time_, and the points that they go through.
  struct Corridor {
    double upper = std::numeric_limits<double>::max();
    double lower = std::numeric_limits<double>::lowest();
    double read = 0, heard = 0;  // times of the points, since last_time_
  };
  Corridor corridor(double rate) const {
    Corridor c;
    for (const Span& s : spans_) {
      double read = s.read.time - last_time_, heard = s.heard.time - last_time_;
      double upper = s.read.clock - read * rate, lower = s.heard.clock - heard * rate;
      if (upper < c.upper) c.upper = upper, c.read = read;
      if (lower > c.lower) c.lower = lower, c.heard = heard;
    }
    return c;
  }
  // What a rate is worth, and how that grows with it, on that side of prior_ where it has a kink.
  struct Tangent {
    double rate, worth, slope;

    double at(double other) const { return worth + slope * (other - rate); }
  };
  Tangent tangent(double rate, bool above) const {
    const Corridor c = corridor(rate);
    const double held = kPriorSeconds * hz_;
    return {rate, c.upper - c.lower - held * std::fabs(rate - prior_),
            c.heard - c.read + (above ? -held : held)};
  }
  Tangent tangent(double rate) const { return tangent(rate, rate > prior_); }
  // The rate of the greatest worth. That is concave, of straight pieces: two tangents on either
  // side meet above the top, or on it.
  void find_rate() {
    rate_ = prior_;
    if (tangent(rate_, true).slope <= 0 && tangent(rate_, false).slope >= 0) return;
    Tangent low = tangent(1 - kRateRange), high = tangent(1 + kRateRange);
    for (int i = 0; i < kMostTangents; ++i) {
      rate_ = low.slope <= 0 ? low.rate : high.rate;
      if (low.slope <= 0 || high.slope >= 0) return;
      rate_ = low.rate + (high.at(low.rate) - low.worth) / (low.slope - high.slope);
      const Tangent here = tangent(rate_);
      if (here.worth >= low.at(rate_) - kFineTicks) return;
      (here.slope > 0 ? low : high) = here;
    }
  }
};

}  // namespace passo::wire
