// The filtered law of one motor, a cubic between breakpoints: impulses, averages over a box of
// time, and pressure advance, applied to one or several planned laws.
//
// Each filter is a sum of copies of the planned law p, which are delayed and may be integrated:
//   impulse             weight * p                   a quadratic
//   box of the width w  weight * (P(t + w/2) - P(t - w/2)) / w with P' = p, a cubic
//   advance             y = advance * p' convolved with two boxes of the widths w and h: y
//                       integrated twice, at (+w +h, +w -h, -w +h, -w -h)/2, times (+ - - +)/(w h)
// So each breakpoint of p changes one derivative of the sum by a constant, at an edge of each
// filter.
#pragma once
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "filters/taps.hpp"

namespace passo {

class SmoothLaw {
 public:
  // Adds what `kernel` makes of a planned law, `delay` ticks later.
  void add(Phases* phases, const Kernel& kernel, double delay, double hz) {
    for (const Impulse& copy : kernel.copies)
      add(phases, copy.weight, delay + copy.at * hz, kernel.box_s * hz);
    for (const Impulse& copy : kernel.copies)
      if (kernel.advances())
        add_advance(phases, copy.weight, delay + copy.at * hz, kernel.wide_s * hz,
                    kernel.narrow_s * hz);
  }
  // Adds a planned law, `delay` ticks later, averaged over a box of this width. Width 0: not
  // averaged.
  void add(Phases* phases, double weight, double delay, double box) {
    if (!(box > 0)) return put({phases, delay, weight, 0, 0});
    put({phases, delay - 0.5 * box, 0, weight / box, 0});
    put({phases, delay + 0.5 * box, 0, -weight / box, 0});
  }
  // Adds the advance of a planned law, averaged over two boxes of these widths.
  void add_advance(Phases* phases, double weight, double delay, double wide, double narrow) {
    const double part = weight / (wide * narrow), out = 0.5 * (wide + narrow),
                 in = 0.5 * (wide - narrow);
    put({phases, delay - out, 0, 0, part});
    put({phases, delay - in, 0, 0, -part});
    put({phases, delay + in, 0, 0, -part});
    put({phases, delay + out, 0, 0, part});
  }

  // The shortest delay in ticks: the law is known up to this long after the end of the plan.
  double earliest() const { return earliest_; }
  // Restarts the law at clock t. Earlier phases have no effect.
  void start(double t) {
    t_ = t;
    for (Edge& e : edges_) {
      e.k = 0;
      while (e.phases->t[e.k + 1] + e.delay <= t) ++e.k;
    }
    sum();
  }
  double t() const { return t_; }
  double q() const { return q_; }

  // Passes on each interval between two breakpoints before `limit`, up to which all breakpoints are
  // known: sink.cubic(start clock, ticks, position, speed, acceleration, jerk, end position, end
  // speed). `last`: no breakpoint follows the known ones.
  template <class Sink>
  void advance(double limit, bool last, Sink& sink) {
    const size_t n = edges_.size();
    for (size_t i = 0; i < n; ++i) due_[i] = due(edges_[i]);
    const int64_t stop = ordered(limit);
    for (;;) {
      int64_t least = due_[0];
      size_t first = 0;
      for (size_t i = 1; i < n; ++i) {
        const bool sooner = due_[i] < least;
        least = sooner ? due_[i] : least;
        first = sooner ? i : first;
      }
      if (least >= stop) break;
      const double end = std::bit_cast<double>(least);
      // Errors of the derivatives grow with time, so a long interval starts with a new sum.
      if (end - t_ > long_ && left_ < kResum) sum();
      if (end > t_) pass_on(end, sink);
      Edge& e = edges_[first];
      const Phases& p = *e.phases;
      const Phases::Change& change = p.change[++e.k];
      due_[first] = due(e);
      double da = 0, dj = 0;
      if (e.advance != 0) {
        da = e.advance * p.advanced[e.k].dy;
        dj = e.advance * p.advanced[e.k].d_slope;
      }
      q_ += e.direct * change.place[0];
      v_ += e.direct * change.place[1] + e.box * change.place[0];
      a_ += e.direct * change.rate[0] + e.box * change.place[1] + da;
      j_ += e.box * change.rate[0] + dj;
      if (--left_ == 0 || (change.rate[1] != 0 && stands())) sum();
    }
    if (!last && limit > t_) pass_on(limit, sink);
  }
  // The first phase of an axis that this law still needs.
  size_t needed(const Phases* phases) const {
    size_t k = std::numeric_limits<size_t>::max();
    for (const Edge& e : edges_)
      if (e.phases == phases) k = std::min(k, e.k);
    return k;
  }
  void dropped(const Phases* phases, size_t k) {
    for (Edge& e : edges_)
      if (e.phases == phases) e.k -= k;
  }

 private:
  static constexpr int kResum = 512;  // breakpoints between two exact sums
  static constexpr double kLongest =
      8;  // longest interval without a new sum, in lengths of the memory
  struct Edge {
    Phases* phases;
    double delay;                 // ticks
    double direct, box, advance;  // weights of the law, of its integral and of its advance
    size_t k = 0;                 // current phase
  };
  std::vector<Edge> edges_;  // grouped by axis, in each the latest first
  std::vector<int64_t> due_;
  double earliest_ = kNeverTicks, long_ = 0, t_ = 0;
  double q_ = 0, v_ = 0, a_ = 0, j_ = 0;
  int left_ = kResum;

  bool stands() const {
    return std::all_of(edges_.begin(), edges_.end(),
                       [](const Edge& e) { return e.phases->stands[e.k] != 0; });
  }
  static int64_t due(const Edge& e) { return ordered(e.phases->t[e.k + 1] + e.delay); }

  void put(const Edge& e) {
    auto at = std::find_if(edges_.begin(), edges_.end(),
                           [&](const Edge& x) { return x.phases == e.phases; });
    while (at != edges_.end() && at->phases == e.phases && at->delay > e.delay) ++at;
    if (at != edges_.end() && at->phases == e.phases && at->delay == e.delay) {
      at->direct += e.direct, at->box += e.box, at->advance += e.advance;
    } else {
      edges_.insert(at, e);
    }
    due_.resize(edges_.size());
    earliest_ = std::min(earliest_, e.delay);
    double latest = 0;
    for (const Edge& x : edges_) latest = std::max(latest, x.delay);
    long_ = kLongest * (latest - earliest_);
  }

  template <class Sink>
  void pass_on(double end, Sink& sink) {
    const double d = end - t_, q = q_ + d * (v_ + d * (0.5 * a_ + d * (j_ * (1.0 / 6)))),
                 v = v_ + d * (a_ + 0.5 * d * j_);
    sink.cubic(t_, d, q_, v_, a_, j_, q, v);
    q_ = q, v_ = v;
    a_ += d * j_;
    t_ = end;
  }

  // Calculates the law at t_ from the phases again. The result is exact if all of them are at
  // standstill.
  void sum() {
    q_ = v_ = a_ = j_ = 0;
    left_ = kResum;
    for (size_t first = 0; first < edges_.size();) {
      size_t end = first + 1;
      while (end < edges_.size() && edges_[end].phases == edges_[first].phases) ++end;
      sum(first, end);
      first = end;
    }
  }
  // Adds one axis, from the clock of its latest edge to that of its earliest edge. Positions are
  // relative to that of the earliest edge, because rounding keeps the weights from adding up to
  // exactly 1.
  void sum(size_t first, size_t end) {
    const Phases& p = *edges_[first].phases;
    const Edge& newest = edges_[end - 1];
    const double reference = p.q[newest.k] + along(p, newest.k, t_ - newest.delay).q;
    // Integral of the position, and the first two integrals of the advance.
    double integral = 0, once = 0, twice = 0, at = t_ - edges_[first].delay;
    size_t k = edges_[first].k;
    q_ += reference;
    for (size_t i = first; i < end; ++i) {
      const Edge& e = edges_[i];
      const double to = t_ - e.delay;
      for (;; ++k) {
        const double until = k == e.k ? to : p.t[k + 1];
        const double d = until - at, q = (p.q[k] - reference) + along(p, k, at).q;
        const double v = along(p, k, at).v, a = p.stands[k] ? 0 : p.a[k];
        integral += d * (q + d * (0.5 * v + d * a * (1.0 / 6)));
        if (!p.advanced.empty()) {
          const double y = advanced(p, k, at), slope = p.advanced[k].slope;
          twice += d * (once + d * (0.5 * y + d * slope * (1.0 / 6)));
          once += d * (y + 0.5 * d * slope);
        }
        at = until;
        if (k == e.k) break;
      }
      const Place here = along(p, k, to);
      const double x = (p.q[k] - reference) + here.q;
      q_ += e.direct * x + e.box * integral;
      v_ += e.direct * here.v + e.box * x;
      a_ += e.direct * p.a[k] + e.box * here.v;
      j_ += e.box * p.a[k];
      if (e.advance != 0) {
        q_ += e.advance * twice;
        v_ += e.advance * once;
        a_ += e.advance * advanced(p, k, to);
        j_ += e.advance * p.advanced[k].slope;
      }
    }
  }
  struct Place {
    double q, v;  // q relative to the start of the phase
  };
  static Place along(const Phases& p, size_t k, double t) {
    if (p.stands[k]) return {0, 0};
    const double u = t - p.t[k];
    return {u * (p.v[k] + 0.5 * p.a[k] * u), p.v[k] + p.a[k] * u};
  }
  static double advanced(const Phases& p, size_t k, double t) {
    const Phases::Advanced& advanced = p.advanced[k];
    const bool acts = advanced.y != 0 || advanced.slope != 0;
    return advanced.y + advanced.slope * (acts ? t - p.t[k] : 0);
  }
};

}  // namespace passo
