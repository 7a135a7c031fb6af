// The planned law of one axis: phases in which its position is a quadratic of time.
#pragma once
#include <algorithm>
#include <cstdint>
#include <cstring>
#include <utility>
#include <vector>

#include "machine/filters.hpp"
#include "plan/move.hpp"

namespace passo {

inline constexpr double kNeverTicks = 1e300;
typedef double Two __attribute__((vector_size(16)));  // vector of two doubles

// Phase k starts at t[k] with position q, speed v and acceleration a, in steps and ticks. change[k]
// is the difference of its start from the calculated end of phase k - 1. After many hours a clock
// has a resolution of only 6e-5 ticks, so that the position jumps a little at each move. Without
// `change`, sums over many breakpoints would drift. The entry after the last phase has t =
// kNeverTicks.
class Phases {
 public:
  struct Change {
    Two place;  // change of q and of v
    Two rate;   // change of a; 1 if a standstill starts, else 0
  };
  // Pressure advance of an extruder: its speed times the advance in seconds. Above each knee,
  // additional speed counts less: the advance over speed is a polyline through 0.
  struct Advanced {
    double y, slope;     // at the start of the phase
    double dy, d_slope;  // difference from the end of the phase before
  };
  std::vector<double> t, q, v, a;
  std::vector<Change> change;
  std::vector<Advanced> advanced;  // empty if the axis has no advance
  std::vector<uint8_t> stands;

  // A knee: above `speed` (steps per tick), additional speed counts with the factor `share`. `all`
  // is the sum up to `speed`.
  struct Bend {
    double speed, share, all;
  };

  explicit Phases(bool advances = false, std::vector<Bend> bends = {})
      : advances_(advances), bends_(std::move(bends)) {
    reserve(kSmallest);
  }
  // Converts knees from mm/s to steps per tick.
  static std::vector<Bend> bends(const std::vector<Knee>& knees, double steps_per_mm, double hz) {
    std::vector<Bend> bends;
    Bend before{0, 1, 0};
    for (const Knee& knee : knees) {
      const double speed = knee.mm_s * steps_per_mm / hz;
      before = {speed, knee.share, before.all + before.share * (speed - before.speed)};
      bends.push_back(before);
    }
    return bends;
  }

  // The axis rests at q0, and has always done so. While it rests, a breakpoint is left out unless
  // it is more than `span` ticks after the last one.
  void begin(double q0, double span) {
    span_ = span;
    t[0] = -span, q[0] = q0, v[0] = a[0] = 0;
    stands[0] = 1;
    if (advances_) advanced[0] = {0, 0, 0, 0};
    end_ = -kNeverTicks;
    at_end_ = q0;
    end_with_never(1);
  }
  // Adds a move of the axis from p0 to p1 steps with an advance in ticks. Phases after `until` are
  // left out. `share`: fraction of the filament that follows this law; the knees depend on the
  // speed of all filament.
  void add(const Move& m, double p0, double p1, double hz, double advance, double until,
           double share = 1) {
    const double u = (p1 - p0) / m.d, w = u / hz, ww = w / hz;
    if (m.start > end_ + 0.5) stand();  // after a pause
    advance_ = advance;
    share_ = share;
    fresh_ = true;
    double at = m.start, distance = 0;
    phase(at, until, p0, w * m.v0, ww * m.a, m.t_acc);
    if (m.t_acc > 0) at += m.t_acc, distance = m.d_acc;
    phase(at, until, p0 + u * distance, w * m.vc, 0, m.t_cru);
    if (m.t_cru > 0) at += m.t_cru, distance += m.d_cru;
    phase(at, until, p0 + u * distance, w * m.vc, -ww * m.b, m.t_dec);
    end_ = m.end();
    at_end_ = p1;
    if (end_ > until) {
      at_end_ = p0 + u * m.along(until - m.start, hz).first;
      end_ = until;
    }
  }
  // The law continues from `clock`, up to which it is known.
  void resume(double clock) {
    if (clock > end_ + 0.5) stand();
    end_ = std::max(end_, clock);
  }
  // The axis rests at the end of the last move.
  void stand() {
    advance_ = 0;
    if (!stands[n_ - 1]) write(end_, at_end_, 0, 0);
  }
  double at_end() const { return at_end_; }

  // Drops the phases before number k. Returns by how much the numbers of the other phases fall.
  size_t drop(size_t k) {
    if (k < kDropped) return 0;
    for (auto* x : {&t, &q, &v, &a}) shift(*x, k, n_ + 1 - k);
    shift(change, k, n_ + 1 - k);
    shift(stands, k, n_ - k);
    if (advances_) shift(advanced, k, n_ + 1 - k);
    n_ -= k;
    return k;
  }

 private:
  static constexpr size_t kSmallest = 256, kDropped = 2048;
  bool advances_;
  std::vector<Bend> bends_;
  bool fresh_ = false;  // the next phase is the first one of its move
  size_t n_ = 0;
  double span_ = 0, end_ = 0, at_end_ = 0, advance_ = 0, share_ = 1;

  template <class T>
  static void shift(std::vector<T>& x, size_t k, size_t n) {
    std::memmove(static_cast<void*>(x.data()), x.data() + k, n * sizeof(T));
  }
  void reserve(size_t size) {
    for (auto* x : {&t, &q, &v, &a}) x->resize(size);
    change.resize(size);
    stands.resize(size);
    if (advances_) advanced.resize(size);
  }
  void end_with_never(size_t n) {
    n_ = n;
    t[n] = kNeverTicks;
    change[n] = {Two{0, 0}, Two{0, 0}};
    if (advances_) advanced[n] = {0, 0, 0, 0};
  }
  void phase(double at, double until, double q_, double v_, double a_, double ticks) {
    if (!(ticks > 0) || at >= until) return;
    const bool idle = v_ == 0 && a_ == 0 && stands[n_ - 1];
    if (!(idle && (!fresh_ || at - t[n_ - 1] > span_))) write(at, q_, v_, a_);
    fresh_ = false;
    if (advance_ == 0 || a_ == 0) return;
    for (size_t i = 0; i < bends_.size(); ++i) {
      const double speed = bends_[a_ > 0 ? i : bends_.size() - 1 - i].speed * share_;
      const double u = (speed - v_) / a_;
      if (u > 0 && u < ticks && at + u < until)
        write(at + u, q_ + u * (v_ + 0.5 * a_ * u), speed, a_);
    }
  }
  void write(double at, double q_, double v_, double a_) {
    if (n_ + 2 > t.size()) reserve(2 * t.size());
    const size_t b = n_ - 1;
    const double d = stands[b] ? 0 : at - t[b];
    const uint8_t rests = v_ == 0 && a_ == 0;
    t[n_] = at, q[n_] = q_, v[n_] = v_, a[n_] = a_;
    stands[n_] = rests;
    change[n_] = {Two{q_ - (q[b] + d * (v[b] + 0.5 * a[b] * d)), v_ - (v[b] + a[b] * d)},
                  Two{a_ - a[b], double(rests)}};
    if (advances_) {
      const Advanced& before = advanced[b];
      double y = advance_ * v_, slope = advance_ * a_;
      for (const Bend& bend : bends_) {
        const double speed = bend.speed * share_;
        if (v_ > speed || (v_ == speed && a_ > 0)) {
          y = advance_ * (bend.all * share_ + bend.share * (v_ - speed));
          slope = advance_ * bend.share * a_;
        }
      }
      advanced[n_] = {y, slope, y - (before.y + before.slope * d), slope - before.slope};
    }
    end_with_never(n_ + 1);
  }
};

}  // namespace passo
