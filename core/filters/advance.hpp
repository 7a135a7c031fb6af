// Pressure advance of one extruder. Its position is e + g, where e is the planned filament and g is
// y = advance * e' convolved with a triangle of half width h, so g'' = (y(t + h) - 2 y(t) + y(t -
// h)) / h^2. Only g is smoothed: e is not shifted in time. Between breakpoints the position is a
// cubic.
#pragma once
#include <cmath>
#include <cstdint>

#include "filters/taps.hpp"

namespace passo {

class Advance {
 public:
  // e follows the plan `delay` ticks later; h must be at most `delay`.
  Advance(Phases* phases, double half_ticks, double delay)
      : phases_(phases), h_(half_ticks), per_hh_(1 / (half_ticks * half_ticks)),
        delay_{delay - half_ticks, delay, delay + half_ticks} {}

  void start(double t) {
    t_ = t;
    for (int i = 0; i < 3; ++i) {
      k_[i] = 0;
      while (phases_->t[k_[i] + 1] + delay_[i] <= t) ++k_[i];
    }
    last_ = 0;
    for (size_t k = 0; k <= k_[0]; ++k)
      if (acts(k)) last_ = k + 1;
    filament();
    sum();
    count_ = std::floor(q_ + g_ + 0.5);
    left_ = kResum;
  }
  double earliest() const { return delay_[0]; }  // see Taps::earliest
  double t() const { return t_; }
  double q() const { return q_ + g_; }

  // Calls sink.counted(start clock, ticks, c0, c1, c2, end, net steps) for each interval that may
  // contain a step. The interval is a cubic on 0..1, relative to the last step count. `last`: see
  // Taps.
  template <class Sink>
  void advance(double limit, bool last, Sink& sink) {
    const Phases& p = *phases_;
    for (;;) {
      double end = p.t[k_[0] + 1] + delay_[0];
      for (int i = 1; i < 3; ++i) {
        const double next = p.t[k_[i] + 1] + delay_[i];
        end = next < end ? next : end;
      }
      if (!(end < limit)) break;
      to(end);
      double d2 = 0, d3 = 0;
      for (int i = 0; i < 3; ++i) {
        const size_t next = k_[i] + 1;
        if (p.t[next] + delay_[i] != end) continue;
        const double weight = i == 1 ? -2 * per_hh_ : per_hh_;
        d2 += weight * p.advanced[next].dy;
        d3 += weight * p.advanced[next].d_slope;
        k_[i] = next;
      }
      g2_ += d2;
      g3_ += d3;
      filament();
      if (acts(k_[0])) last_ = k_[0] + 1;
      if (k_[2] >= last_) {
        g_ = g1_ = g2_ = g3_ = 0;  // no advance within the width of the triangle
        left_ = kResum;
      } else if (--left_ == 0) {
        sum();
        left_ = kResum;
      }
      settle(sink);
    }
    if (!last && limit > t_) {
      to(limit);
      filament();
      settle(sink);
    }
  }
  size_t needed(const Phases*) const { return k_[2]; }
  void dropped(const Phases*, size_t k) {
    for (size_t& i : k_) i -= k;
    last_ -= std::min(last_, k);
  }

 private:
  static constexpr int kResum = 64;
  Phases* phases_;
  double h_, per_hh_, delay_[3];
  size_t k_[3] = {0, 0, 0};                  // phase at t + h, t and t - h of the delayed plan
  size_t last_ = 0;                          // index after the last phase that has an advance
  double t_ = 0, q_ = 0, v_ = 0, a_ = 0;     // position, speed and acceleration of e
  double g_ = 0, g1_ = 0, g2_ = 0, g3_ = 0;  // g and its derivatives
  double count_ = 0;
  int left_ = kResum;
  // The interval that ends at t_: its length, and the coefficients of its cubic, relative to the
  // count.
  double d_ = 0, c0_ = 0, c1_ = 0, c2_ = 0;

  bool acts(size_t k) const {
    const Phases::Advanced& advanced = phases_->advanced[k];
    return advanced.y != 0 || advanced.slope != 0;
  }
  // Calculates e at t_ from its current phase.
  void filament() {
    const Phases& p = *phases_;
    const size_t k = k_[1];
    const double u = p.stands[k] ? 0 : t_ - delay_[1] - p.t[k];
    a_ = p.a[k];
    v_ = p.v[k] + a_ * u;
    q_ = p.q[k] + u * (p.v[k] + 0.5 * a_ * u);
  }
  void to(double end) {
    const double d = end - t_, g3d = g3_ * d;
    d_ = d;
    c0_ = (q_ - count_) + g_;
    c1_ = (v_ + g1_) * d;
    c2_ = 0.5 * (a_ + g2_) * d * d;
    g_ = g_ + d * (g1_ + d * (0.5 * g2_ + g3d * (1.0 / 6)));
    g1_ = g1_ + d * (g2_ + 0.5 * g3d);
    g2_ = g2_ + g3d;
    t_ = end;
  }
  template <class Sink>
  void settle(Sink& sink) {
    const double end = (q_ - count_) + g_, n = std::floor(end + 0.5);
    // If the four Bezier values are less than half a step from the count, the interval has no step.
    const double b1 = c0_ + c1_ * (1.0 / 3), b2 = c0_ + (2 * c1_ + c2_) * (1.0 / 3);
    if ((n == 0) & (b1 < 0.5) & (b2 < 0.5) & (b1 > -0.5) & (b2 > -0.5)) return;
    sink.counted(t_ - d_, d_, c0_, c1_, c2_, end, n);
    count_ += n;
  }
  // Calculates g and its derivatives again, from all phases within the width of the triangle.
  void sum() {
    const Phases& p = *phases_;
    const double from = t_ - delay_[2];
    double once = 0, twice = 0, once_middle = 0, twice_middle = 0;  // integrals of y from t - h on
    double y[3] = {0, 0, 0}, slope[3] = {0, 0, 0}, at = from;
    for (size_t k = k_[2];; ++k) {
      // Integrates up to the middle, the end, or the next phase.
      const double y0 = p.advanced[k].y + p.advanced[k].slope * (acts(k) ? at - p.t[k] : 0);
      const double b = p.advanced[k].slope;
      auto go = [&](double begin, double to, double begin_y) {
        const double u = to - begin;
        twice += u * (once + u * (0.5 * begin_y + u * b * (1.0 / 6)));
        once += u * (begin_y + 0.5 * b * u);
      };
      double begin = at, begin_y = y0;
      if (k == k_[2]) y[2] = y0, slope[2] = b;
      if (k == k_[1]) {
        const double middle = t_ - delay_[1];
        go(begin, middle, begin_y);
        begin_y += b * (middle - begin);
        begin = middle;
        once_middle = once, twice_middle = twice;
        y[1] = begin_y, slope[1] = b;
      }
      const double end = k == k_[0] ? t_ - delay_[0] : p.t[k + 1];
      go(begin, end, begin_y);
      if (k == k_[0]) {
        y[0] = begin_y + b * (end - begin), slope[0] = b;
        break;
      }
      at = end;
    }
    g_ = (twice - 2 * twice_middle) * per_hh_;
    g1_ = (once - 2 * once_middle) * per_hh_;
    g2_ = ((y[0] - y[1]) - (y[1] - y[2])) * per_hh_;
    g3_ = ((slope[0] - slope[1]) - (slope[1] - slope[2])) * per_hh_;
  }
};

}  // namespace passo
