#include "link/clock_sync.hpp"

#include <algorithm>
#include <cmath>

namespace passo::wire {

double ClockLine::clock_at(double host) const {
  return double(origin_clock) + (clock + (host - double(origin_time) - time) * rate);
}

double ClockLine::host_at(double board) const {
  return double(origin_time) + (time + (board - double(origin_clock) - clock) / rate);
}

void ClockSync::start(Ticks clock, Ticks sent, Ticks received) {
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

void ClockSync::bridge(Ticks host) {
  if (ready_) last_clock_ = std::max(last_clock_, clock_at(host));
}

Ticks ClockSync::unwrap(uint32_t clock) const {
  return last_clock_ + int32_t(clock - uint32_t(uint64_t(last_clock_)));
}

void ClockSync::add(uint32_t clock32, Ticks sent, Ticks received) {
  Ticks clock = unwrap(clock32);
  // No clock runs backwards, but the clock of a sleeping host pauses.
  if (clock < last_clock_ - Ticks(hz_)) clock += Ticks(1) << 32;
  last_clock_ = std::max(last_clock_, clock);
  const double trip = double(received - sent), asked = double(sent - origin_time_);
  // The shortest delay may have grown since.
  double passed = std::max(asked - last_time_, 0.0);
  shortest_trip_ = std::min(trip, shortest_trip_ + passed * kTripAging);
  usual_excess_ += (trip - shortest_trip_ - usual_excess_) * kExcessGain;
  take(asked, asked + trip, double(clock - origin_clock_));
}

Ticks ClockSync::clock_at(Ticks host) const {
  double along = (double(host - origin_time_) - last_time_) * rate_;
  return origin_clock_ + Ticks(std::floor(value_ + along + 0.5));
}

Ticks ClockSync::host_at(Ticks clock) const {
  double along = (double(clock - origin_clock_) - value_) / rate_;
  return origin_time_ + Ticks(std::ceil(last_time_ + along));
}

void ClockSync::take(double asked, double received, double clock) {
  const Span now{asked, {asked, clock}, {received, clock}};
  while (!spans_.empty() && spans_.front().begin < asked - kMemorySeconds * hz_) spans_.pop_front();
  if (spans_.empty()) prior_ = rate_;
  if (spans_.empty() || asked >= spans_.back().begin + kSpanSeconds * hz_) {
    spans_.push_back(now);
  } else {
    Span& last = spans_.back();
    auto offset = [this](const Point& p) { return p.clock - p.time * rate_; };
    if (offset(now.read) < offset(last.read)) last.read = now.read;
    if (offset(now.received) > offset(last.received)) last.received = now.received;
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

ClockSync::Corridor ClockSync::corridor(double rate) const {
  Corridor c;
  for (const Span& s : spans_) {
    double read = s.read.time - last_time_, received = s.received.time - last_time_;
    double upper = s.read.clock - read * rate, lower = s.received.clock - received * rate;
    if (upper < c.upper) c.upper = upper, c.read = read;
    if (lower > c.lower) c.lower = lower, c.received = received;
  }
  return c;
}

ClockSync::Tangent ClockSync::tangent(double rate, bool above) const {
  const Corridor c = corridor(rate);
  const double held = kPriorSeconds * hz_;
  return {rate, c.upper - c.lower - held * std::fabs(rate - prior_),
          c.received - c.read + (above ? -held : held)};
}

void ClockSync::find_rate() {
  rate_ = prior_;
  if (tangent(rate_, true).slope <= 0 && tangent(rate_, false).slope >= 0) return;
  Tangent low = tangent(1 - kRateRange), high = tangent(1 + kRateRange);
  for (int i = 0; i < kMaxTangents; ++i) {
    rate_ = low.slope <= 0 ? low.rate : high.rate;
    if (low.slope <= 0 || high.slope >= 0) return;
    rate_ = low.rate + (high.at(low.rate) - low.worth) / (low.slope - high.slope);
    const Tangent here = tangent(rate_);
    if (here.worth >= low.at(rate_) - kFineTicks) return;
    (here.slope > 0 ? low : high) = here;
  }
}

}  // namespace passo::wire
