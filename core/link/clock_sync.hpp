// The board's clock as the host estimates it: a line between the bounds from the answers to
// get_clock.
#pragma once
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

  double clock_at(double host) const;
  double host_at(double board) const;
};

// Host time is counted in ticks of the nominal frequency; board clocks are 64 bits, unwrapped from
// the 32 that the board sends.
//
// The board reads a question after the host sent it, and the host receives the answer after the
// board made it: each bounds the line from one side. If neither was delayed much, both bounds are
// tight. The line is the middle of the corridor between the bounds, at the rate at which the
// corridor is widest. Delayed answers touch no bound, and the error falls with the number of
// answers, not with its square root. (Delays of two ways by hulls: Moon, Skelly, Towsley,
// "Estimation and removal of clock skew from network delay measurements", INFOCOM 1999.) The least
// delays of both ways are taken to be equal.
class ClockSync {
 public:
  explicit ClockSync(double clock_hz) : hz_(clock_hz) {}

  bool ready() const { return ready_; }

  // First sample, from the 64-bit answer to get_uptime. Times in host ticks.
  void start(Ticks clock, Ticks sent, Ticks received);

  // The board was not queried until this host time.
  void bridge(Ticks host);
  // Extends the low 32 bits of a clock that is within 2^31 ticks of the last known one.
  Ticks unwrap(uint32_t clock) const;

  void add(uint32_t clock32, Ticks sent, Ticks received);

  // The usual delay of an answer in addition to the quickest ones, seconds.
  double jitter_s() const { return usual_excess_ / hz_; }
  ClockLine line() const { return {origin_time_, origin_clock_, last_time_, value_, rate_}; }
  // Board clock at a host time.
  Ticks clock_at(Ticks host) const;
  // Host time at which the board's clock reads `clock`.
  Ticks host_at(Ticks clock) const;
  // Board ticks per host tick.
  double rate() const { return rate_; }

 private:
  static constexpr double kTripAging = 1e-6;  // seconds in each second
  static constexpr double kExcessGain = 1.0 / 16;
  static constexpr double kMemorySeconds = 40, kSpanSeconds = 0.15;
  static constexpr double kRateRange = 0.01;  // worst resonators, in both directions
  // A rate must widen the corridor by this many seconds for each unit of difference from the
  // earlier estimate, because a short time does not define the rate well. Within one span nothing
  // bounds the rate, because sending and receiving may be as far apart as the span is long.
  static constexpr double kPriorSeconds = 0.2;
  static_assert(kSpanSeconds < kPriorSeconds);
  static constexpr double kJumpSeconds = 0.5e-3;  // a narrower corridor means that a clock has
                                                  // jumped
  static constexpr int kMaxTangents = 64;         // usually four to eight are enough
  static constexpr double kFineTicks = 1e-4;      // more than rounding errors, and too little to
                                                  // matter

  struct Point {
    double time, clock;  // since the origin
  };
  // The tightest bounds of a period: from the earliest question that was read, and the earliest
  // answer that was received.
  struct Span {
    double begin;
    Point read, received;
  };

  double hz_;
  bool ready_ = false;
  Ticks origin_time_ = 0, origin_clock_ = 0, last_clock_ = 0;
  std::deque<Span> spans_;
  double last_time_ = 0, value_ = 0;  // the line goes through this point
  double rate_ = 1, prior_ = 1, shortest_trip_ = 0, usual_excess_ = 0;

  void take(double asked, double received, double clock);
  // The corridor at a rate: its bounds at last_time_, and the points that define them.
  struct Corridor {
    double upper = std::numeric_limits<double>::max();
    double lower = std::numeric_limits<double>::lowest();
    double read = 0, received = 0;  // times of the points, since last_time_
  };
  Corridor corridor(double rate) const;
  // The score of a rate, and the derivative of the score by rate; at prior_, where it has a kink,
  // the derivative on the given side.
  struct Tangent {
    double rate, worth, slope;

    double at(double other) const { return worth + slope * (other - rate); }
  };
  Tangent tangent(double rate, bool above) const;
  Tangent tangent(double rate) const { return tangent(rate, rate > prior_); }
  // The rate with the highest score. The score is concave and piecewise linear: tangents from
  // either side meet above the maximum, or at it.
  void find_rate();
};

}  // namespace passo::wire
