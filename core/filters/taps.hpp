// The filtered law of one linear motor: a sum of impulses, each a delayed copy of the planned law
// of an axis. A sum of quadratics is a quadratic between breakpoints, so the result is exact.
#pragma once
#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>

#include "filters/phases.hpp"

namespace passo {

// After any breakpoint, and before kNeverTicks.
inline constexpr double kAllTicks = 1e299;

// Positive doubles have the same order as their bit patterns.
inline int64_t ordered(double x) { return std::bit_cast<int64_t>(x); }

class Taps {
 public:
  static constexpr int kMost = 16;
  struct Tap {
    Phases* phases;
    double weight, delay;  // ticks
    size_t k = 0;          // current phase
  };

  void add(Phases* phases, double weight, double delay) {
    taps_[n_++] = {phases, weight, delay};
    earliest_ = std::min(earliest_, delay);
  }

  // The shortest delay in ticks: the law is known up to this long after the end of the plan.
  double earliest() const { return earliest_; }
  // Restarts the law at clock t. Earlier phases have no effect.
  void start(double t) {
    t_ = t;
    for (int i = 0; i < n_; ++i) {
      Tap& tap = taps_[i];
      tap.k = 0;
      while (tap.phases->t[tap.k + 1] + tap.delay <= t) ++tap.k;
    }
    sum();
    left_ = kResum;
  }
  double t() const { return t_; }
  double q() const { return q_; }

  // Passes on each interval between two breakpoints before `limit`, up to which all breakpoints are
  // known: sink.add(end clock, end position, speed at start and end, acceleration). `last`: no
  // breakpoint follows the known ones.
  template <class Sink>
  void advance(double limit, bool last, Sink& sink) {
    if (n_ == 1)
      walk<1>(limit, sink);
    else if (n_ == 2)
      walk<2>(limit, sink);
    else if (n_ == 3)
      walk<3>(limit, sink);
    else if (n_ == 4)
      walk<4>(limit, sink);
    else if (n_ == 5)
      walk<5>(limit, sink);
    else if (n_ == 6)
      walk<6>(limit, sink);
    else
      walk<0>(limit, sink);
    // The known part ends at a breakpoint. What changes there is not known yet.
    if (!last && limit > t_ && !(v_ == 0 && a_ == 0)) {
      const double d = limit - t_, v = v_ + a_ * d;
      q_ = q_ + d * (v_ + 0.5 * a_ * d);
      sink.add(limit, q_, v_, v, a_);
      v_ = v;
      t_ = limit;
    }
  }
  // The first phase of an axis that this law still needs.
  size_t needed(const Phases* phases) const {
    size_t k = std::numeric_limits<size_t>::max();
    for (int i = 0; i < n_; ++i)
      if (taps_[i].phases == phases) k = std::min(k, taps_[i].k);
    return k;
  }
  void dropped(const Phases* phases, size_t k) {
    for (int i = 0; i < n_; ++i)
      if (taps_[i].phases == phases) taps_[i].k -= k;
  }

 private:
  static constexpr int kResum = 64;  // breakpoints between two exact sums
  int n_ = 0, left_ = kResum;
  Tap taps_[kMost];
  double earliest_ = kNeverTicks, t_ = 0, q_ = 0, v_ = 0, a_ = 0;

  // Calculates the law at t_ from the current phases again. The result is exact if all of them are
  // at standstill.
  void sum() {
    double x[kMost];
    v_ = a_ = q_ = 0;
    for (int i = 0; i < n_; ++i) {
      const Phases& p = *taps_[i].phases;
      const size_t k = taps_[i].k;
      const double u = p.stands[k] ? 0 : t_ - taps_[i].delay - p.t[k], w = taps_[i].weight;
      x[i] = p.q[k] + u * (p.v[k] + 0.5 * p.a[k] * u);
      v_ += w * (p.v[k] + p.a[k] * u);
      a_ += w * p.a[k];
    }
    // Positions of each axis are relative to its last impulse, because rounding keeps the weights
    // from adding up to exactly 1.
    for (int first = 0; first < n_;) {
      int end = first + 1;
      double part = 0;
      while (end < n_ && taps_[end].phases == taps_[first].phases) ++end;
      for (int i = first; i < end; ++i) part += taps_[i].weight * (x[i] - x[end - 1]);
      q_ += x[end - 1] + part;
      first = end;
    }
  }

  template <int N, class Sink>
  void walk(double limit, Sink& sink) {
    // All values are local variables: the compiler cannot exclude that the sink writes to members.
    constexpr int kRoom = N > 0 ? N : kMost;
    const int n = N > 0 ? N : n_;
    const double* times[kRoom];
    const Phases::Change* changes[kRoom];
    size_t next[kRoom];
    int64_t due[kRoom];
    double delay[kRoom], weight[kRoom][2];
    for (int i = 0; i < n; ++i) {
      times[i] = taps_[i].phases->t.data();
      changes[i] = taps_[i].phases->change.data();
      next[i] = taps_[i].k + 1;
      delay[i] = taps_[i].delay;
      due[i] = ordered(times[i][next[i]] + delay[i]);
      weight[i][0] = 0, weight[i][1] = taps_[i].weight;
    }
    const int64_t stop = ordered(limit);
    double t = t_, q = q_, v = v_, a = a_;
    int left = left_;
    for (;;) {
      int64_t least = due[0];
#pragma GCC unroll 8
      for (int i = 1; i < n; ++i) least = due[i] < least ? due[i] : least;
      if (least >= stop) break;
      const double end = std::bit_cast<double>(least), d = end - t;
      Two place{0, 0}, rate{0, 0};  // changes of the phases that are due, usually of one
#pragma GCC unroll 8
      for (int i = 0; i < n; ++i) {
        const size_t now = due[i] == least;
        const Phases::Change& change = changes[i][next[i]];
        place = place + change.place * weight[i][now];
        rate = rate + change.rate * weight[i][now];
        next[i] += now;
        due[i] = ordered(times[i][next[i]] + delay[i]);
      }
      const double v0 = v, v1 = v + a * d, a0 = a;
      q = (q + d * (v + 0.5 * a * d)) + place[0];
      v = v1 + place[1];
      a = a + rate[0];
      t = end;
      if (--left == 0 || rate[1] != 0) [[unlikely]] {
        for (int i = 0; i < n; ++i) taps_[i].k = next[i] - 1;
        t_ = t, left = kResum;
        sum();
        q = q_, v = v_, a = a_;
      }
      sink.add(end, q, v0, v1, a0);
    }
    for (int i = 0; i < n; ++i) taps_[i].k = next[i] - 1;
    t_ = t, q_ = q, v_ = v, a_ = a, left_ = left;
  }
};

}  // namespace passo
