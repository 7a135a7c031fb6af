// The longest (interval, count, add) that keeps every step inside its window.
//
// Step m (0-based) of a command is executed (m+1) I + m(m+1)/2 A ticks after the step before the
// command. Divided by m+1 that is the line I + A x at x = m/2, which must stab the vertical
// segments [lo_m, hi_m] / (m+1): the stabbing-line problem (O'Rourke, "An on-line algorithm for
// fitting straight lines between data ranges", 1981). Over the first steps the range of possible
// slopes is kept exactly, from all pairs of segments and without branches; when it holds but few
// integers, each of these is tried to its end.
#pragma once
#include <algorithm>
#include <cmath>

#include "lanes.hpp"
#include "simd.hpp"

namespace passo {

struct Command {
  int count;
  double interval, add;  // integers
};

class Stabbing {
 public:
  static constexpr int kLongest = 4096;  // steps a command at most, of the protocol's 65535

  Stabbing() {
    for (int i = 1; i <= kLongest; ++i) reciprocal_[i] = 1.0 / i;
    for (int j = 0; j < kPairs; ++j) descending_[j] = 1.0 / (kPairs - j);
  }

  // lo[m] ≤ time of step m ≤ hi[m], each window holding an integer; `last` is the integer time of
  // the step before. Returns a command of 1 ≤ count ≤ n; neither `lo` nor `hi` is read beyond n.
  PASSO_SIMD Command longest(const double* lo, const double* hi, int n, double last) {
    n = std::min(n, kLongest);
    if (n == 1) return single(lo, hi, last);
    int reached = slopes(lo, hi, std::min(n, kPairs), last);
    if (reached == kPairs && n > kPairs) {
      Command command = extend(lo, hi, n, last);
      if (command.count >= reached) return command;
    }
    for (int count = reached; count >= 2; --count) {
      Command command = shortened(lo, hi, count, last);
      if (command.count > 0) return command;
    }
    return single(lo, hi, last);
  }

 private:
  static constexpr int kPairs = 24;
  static constexpr double kSlack =
      1e-9;  // ticks: rounding of the divided bounds; × count, the most a step may be out
  static constexpr double kLeastAdd = -32768, kMostAdd = 32767;

  double reciprocal_[kLongest + 1];
  double descending_[kPairs];                    // 1/kPairs … 1
  double low_[kPairs], high_[kPairs];            // the segments
  double least_[kPairs + 1], most_[kPairs + 1];  // slopes per segment, for each count

  static Command single(const double* lo, const double* hi, double last) {
    return {1, round_even((lo[0] + hi[0]) * 0.5 - last), 0};
  }

  // Fills low_, high_, least_, most_; returns the count up to which some line stabs all segments.
  PASSO_INLINE int slopes(const double* lo, const double* hi, int n, double last) {
    low_[0] = lo[0] - last;
    high_[0] = hi[0] - last;
    low_[1] = (lo[1] - last) * 0.5;
    high_[1] = (hi[1] - last) * 0.5;
    double least = low_[1] - high_[0], most = high_[1] - low_[0];
    least_[2] = least;
    most_[2] = most;
    for (int m = 2; m < n; ++m) {
      double low = (lo[m] - last) * reciprocal_[m + 1], high = (hi[m] - last) * reciprocal_[m + 1];
      low_[m] = low;
      high_[m] = high;
      Lanes steepest(most), flattest(least);
      const double* per_distance = descending_ + (kPairs - m);  // [j] = 1/(m - j)
      for (int j = m - 2; j > -2; j -= 2) {
        int k = std::max(j, 0);
        Lanes r = Lanes::load(per_distance + k);
        steepest = min(steepest, (Lanes(high) - Lanes::load(low_ + k)) * r);
        flattest = max(flattest, (Lanes(low) - Lanes::load(high_ + k)) * r);
      }
      most = steepest.least();
      least = flattest.most();
      if (least > most) return m;
      least_[m + 1] = least;
      most_[m + 1] = most;
    }
    return n;
  }

  struct Candidates {
    double first, last, middle;
    PASSO_INLINE Candidates(double least, double most)
        : first(std::max(ceil_fast(2 * least), kLeastAdd)),
          last(std::min(floor_fast(2 * most), kMostAdd)),
          middle(std::min(std::max(round_even(least + most), first), last)) {}
  };

  // Few adds are left: the longest of them.
  PASSO_INLINE Command extend(const double* lo, const double* hi, int n, double last) {
    Candidates adds(least_[kPairs], most_[kPairs]);
    Command best{0, 0, 0};
    if (adds.first > adds.last) return best;
    double low = 0, high = 0;
    auto attempt = [&](double add) PASSO_INLINE_LAMBDA {
      double l, h;
      int count = reach(lo, hi, n, last, add, l, h);
      if (count <= best.count) return;
      best = {count, 0, add};
      low = l;
      high = h;
    };
    attempt(adds.middle);
    for (double d = 1; d <= 2; ++d) {
      if (adds.middle - d >= adds.first) attempt(adds.middle - d);
      if (adds.middle + d <= adds.last) attempt(adds.middle + d);
    }
    return best.count > 0 ? centred(lo, hi, last, best.count, best.add, low, high) : best;
  }

  // Number of steps that hold with this add, and the range of the interval.
  PASSO_INLINE int reach(const double* lo, const double* hi, int n, double last, double add,
                         double& low, double& high) const {
    double l = -1e15, h = 1e15;
    int m = 0;
    for (; m < n; ++m) {
      double r = reciprocal_[m + 1], x = 0.5 * add * m;
      double nl = std::max(l, (lo[m] - last) * r - x), nh = std::min(h, (hi[m] - last) * r - x);
      if (round_even(nl + (0.5 - kSlack)) > round_even(nh - (0.5 - kSlack))) break;
      l = nl;
      h = nh;
    }
    low = l;
    high = h;
    return m;
  }

  // A command of exactly `count` steps, if integers allow; else its count is 0.
  PASSO_INLINE Command shortened(const double* lo, const double* hi, int count, double last) const {
    Candidates adds(least_[count], most_[count]);
    for (double d : {0.0, 1.0, -1.0}) {
      double add = adds.middle + d;
      if (add < adds.first || add > adds.last) continue;
      double l = -1e300, h = 1e300;
      for (int m = 0; m < count; ++m) {
        double x = 0.5 * add * m;
        l = std::max(l, low_[m] - x);
        h = std::min(h, high_[m] - x);
      }
      if (ceil_fast(l - kSlack) <= floor_fast(h + kSlack))
        return centred(lo, hi, last, count, add, l, h);
    }
    return {0, 0, 0};
  }

  // Of the possible intervals, the one whose last step is nearest to its ideal.
  PASSO_INLINE Command centred(const double* lo, const double* hi, double last, int count,
                               double add, double low, double high) const {
    double ideal = (lo[count - 1] + hi[count - 1]) * 0.5 - last - 0.5 * count * (count - 1.0) * add;
    double interval = round_even(ideal * reciprocal_[count]);
    return {count, std::min(std::max(interval, ceil_fast(low - kSlack)), floor_fast(high + kSlack)),
            add};
  }
};

}  // namespace passo
