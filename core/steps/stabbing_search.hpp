// The class that searches the longest command. It is included once for each kind of vector, with
// Vector as its name. PASSO_SEARCH_INLINE and PASSO_SEARCH_APART are the attributes of its
// functions, because the compiler must know for which CPU each function is.
class Search {
 public:
  // See Stabbing::longest.
  PASSO_SEARCH_INLINE Command longest(const double* lo, const double* hi, int n, double last,
                                      double* executed) {
    return block<0>(lo, hi, n, last, executed, Vector(kFar), Vector(-kFar));
  }

  // See Stabbing::errors.
  PASSO_SEARCH_INLINE static Errors errors(const double* t, const double* lo, const double* hi,
                                           const double* executed, size_t n) {
    Vector largest(0), square(0), beyond(-1);
    size_t m = 0;
    for (; m + 4 <= n; m += 4) {
      Vector at = Vector::load(executed + m), error = at - Vector::load(t + m);
      largest = max(largest, max(error, Vector(0) - error));
      square = square + error * error;
      beyond = max(beyond, max(Vector::load(lo + m) - at, at - Vector::load(hi + m)));
    }
    double squares[4];
    square.store(squares);
    Errors e{largest.most(), (squares[0] + squares[1]) + (squares[2] + squares[3]), beyond.most()};
    for (; m < n; ++m) {
      double error = executed[m] - t[m];
      e.largest = std::max(e.largest, std::fabs(error));
      e.square += error * error;
      e.beyond = std::max({e.beyond, lo[m] - executed[m], executed[m] - hi[m]});
    }
    return e;
  }

 private:
  static constexpr int kPairs = 24;
  static constexpr double kFar = 1e300;
  static constexpr double kSlack = 1e-9;  // ticks, tolerance of the divided bounds; times `count`
                                          // it is the maximum error of a step
  static constexpr double kMinAdd = -32768, kMaxAdd = 32767;

  double low_[kPairs], high_[kPairs];  // bounds of the segments
  double least_[kPairs + 1],
      most_[kPairs + 1];  // minimum and maximum slope for each number of segments

  // A command should end as late as possible. Where the speed changes, the step times curve
  // upwards, so the next command can be longer after a late start.
  static Command single(const double* hi, double last) { return {1, std::floor(hi[0] - last), 0}; }

  // Adds the segments m … m + 3. The segments before allow slopes from `least` to `most`. The
  // blocks are unrolled, so that their number costs only one branch.
  template <int m>
  PASSO_SEARCH_INLINE Command block(const double* lo, const double* hi, int n, double last,
                                    double* executed, Vector most, Vector least) {
    const Vector origin(last), far(kFar), back(-kFar), half(0.5), third(1.0 / 3);
    Vector r = Vector::load(kStabbing.reciprocal + m + 1);
    Vector low = (Vector::load(lo + m) - origin) * r, high = (Vector::load(hi + m) - origin) * r;
    low.store(low_ + m);
    high.store(high_ + m);
    // Compares the four segments with each other.
    Vector steepest = high - slide<1>(back, low), flattest = low - slide<1>(far, high);
    steepest = min(steepest, (high - slide<2>(back, low)) * half);
    flattest = max(flattest, (low - slide<2>(far, high)) * half);
    steepest = min(steepest, (high - slide<3>(back, low)) * third);
    flattest = max(flattest, (low - slide<3>(far, high)) * third);
    // Compares the four segments with those before.
    for (int j = 0; j < m; ++j) {
      Vector per_distance = Vector::load(kStabbing.reciprocal + m - j);
      steepest = min(steepest, (high - Vector(low_[j])) * per_distance);
      flattest = max(flattest, (low - Vector(high_[j])) * per_distance);
    }
    // For each segment, combines its slopes with those of all segments before it.
    steepest = min(steepest, slide<1>(far, steepest));
    flattest = max(flattest, slide<1>(back, flattest));
    most = min(most, min(steepest, slide<2>(far, steepest)));
    least = max(least, max(flattest, slide<2>(back, flattest)));
    most.store(most_ + m + 1);
    least.store(least_ + m + 1);
    unsigned crossed = above(least, most);
    if (crossed || n <= m + 4)
      return finish<m / 4 + 1>(hi, std::min(n, m + std::countr_zero(crossed | 16)), last, executed);
    if constexpr (m + 4 < kPairs) {
      return block<m + 4>(lo, hi, n, last, executed, most.last(), least.last());
    } else {
      Command command = extend(lo, hi, n, last);
      if (command.count >= kPairs) {
        execute(command, command.count, last, executed);
        return command;
      }
      return finish<kPairs / 4>(hi, kPairs, last, executed);
    }
  }

  // The longest command of at most `count` steps within the first `blocks` blocks.
  template <int blocks>
  PASSO_SEARCH_APART Command finish(const double* hi, int count, double last,
                                    double* executed) const {
    Command command{0, 0, 0};
    for (; count >= 2 && command.count == 0; --count) command = shortened<blocks>(count);
    if (command.count == 0) command = single(hi, last);
    execute(command, 4 * blocks, last, executed);
    return command;
  }

  // Calculates the times of `count` steps, rounded up to a multiple of four.
  PASSO_SEARCH_INLINE static void execute(const Command& c, int count, double last,
                                          double* executed) {
    const Vector sixteenth(16 * c.add);
    Vector at = Vector(last) + Vector(c.interval) * Vector::load(kStabbing.counts) +
                Vector(c.add) * Vector::load(kStabbing.triangles);
    Vector step =
        Vector(4 * c.interval + 6 * c.add) + Vector(4 * c.add) * Vector::load(kStabbing.counts);
    at.store(executed);
    for (int m = 4; m < count; m += 4, step = step + sixteenth) {
      at = at + step;
      at.store(executed + m);
    }
  }

  // The integer nearest to the middle of the range of `add`. If the range contains an integer, the
  // result is in it.
  static double middle(double least, double most) {
    return std::min(std::max(round_even(least + most), kMinAdd), kMaxAdd);
  }
  static bool possible(double add, double least, double most) {
    return add >= 2 * least && add <= 2 * most && add >= kMinAdd && add <= kMaxAdd;
  }
  // Rounds up or down. A number that exceeds an integer only by rounding errors becomes that
  // integer.
  static double at_least(double x) { return round_even(x + (0.5 - kSlack)); }
  static double at_most(double x) { return round_even(x - (0.5 - kSlack)); }
  PASSO_SEARCH_INLINE static Vector at_least(Vector x) {
    return ((x + Vector(0.5 - kSlack)) + Vector(kRoundMagic)) - Vector(kRoundMagic);
  }
  PASSO_SEARCH_INLINE static Vector at_most(Vector x) {
    return ((x - Vector(0.5 - kSlack)) + Vector(kRoundMagic)) - Vector(kRoundMagic);
  }

  // A command of exactly `count` steps; its count is 0 if no integers fit. A larger `add` ends
  // later.
  template <int blocks>
  PASSO_SEARCH_INLINE Command shortened(int count) const {
    const double least = least_[count], most = most_[count], centre = middle(least, most);
    const double top = std::max(std::min(at_most(2 * most), kMaxAdd), centre);
    for (double add : {top, top - 1, centre, centre + 1, centre - 1}) {
      if (!possible(add, least, most)) continue;
      Vector lows(-kFar), highs(kFar);
      for (int m = 0; m < 4 * blocks; m += 4) {
        Vector x = Vector(add) * Vector::load(kStabbing.halves + m);
        Vector beyond = Vector::load(kStabbing.beyond + std::clamp(m + 4 - count, 0, 4));
        lows = max(lows, Vector::load(low_ + m) - beyond - x);
        highs = min(highs, Vector::load(high_ + m) + beyond - x);
      }
      double low = at_least(lows.most()), high = at_most(highs.least());
      if (low <= high) return {count, high, add};
    }
    return {0, 0, 0};
  }

  // Tries the few remaining values of `add`, and returns the longest command.
  PASSO_SEARCH_APART Command extend(const double* lo, const double* hi, int n, double last) const {
    const double least = least_[kPairs], most = most_[kPairs], centre = middle(least, most);
    Command best{0, 0, 0};
    double high = 0;
    for (double add : {centre, centre - 1, centre + 1, centre - 2, centre + 2}) {
      if (!possible(add, least, most)) continue;
      double h;
      int count = reach(lo, hi, n, last, add, h);
      if (count <= best.count) continue;
      best = {count, 0, add};
      high = h;
    }
    if (best.count == 0) return best;
    return {best.count, at_most(high), best.add};
  }

  // The number of steps that are possible with this `add`, and the maximum interval in `high`.
  // Returns 0 for less than kPairs steps.
  PASSO_SEARCH_INLINE int reach(const double* lo, const double* hi, int n, double last, double add,
                                double& high) const {
    const Vector origin(last), stride(2 * add), back(-kFar), far(kFar);
    Vector x = Vector(add) * Vector::load(kStabbing.halves), lows = back, highs = far;
    int m = 0;
    for (; m < kPairs; m += 4, x = x + stride) {
      lows = max(lows, Vector::load(low_ + m) - x);
      highs = min(highs, Vector::load(high_ + m) - x);
    }
    if (at_least(lows.most()) > at_most(highs.least())) return 0;
    for (; m < n; m += 4, x = x + stride) {
      const Vector r = Vector::load(kStabbing.reciprocal + m + 1);
      Vector l = (Vector::load(lo + m) - origin) * r - x,
             h = (Vector::load(hi + m) - origin) * r - x;
      const Vector all_lows = max(lows, l), all_highs = min(highs, h);
      if (m + 4 > n || at_least(all_lows.most()) > at_most(all_highs.least())) {
        // Only some of these four steps are possible, and their number is hard to predict. So the
        // bounds up to each of them are calculated without branches.
        l = max(l, slide<1>(back, l));
        l = max(max(l, slide<2>(back, l)), Vector(lows.most()));
        h = min(h, slide<1>(far, h));
        h = min(min(h, slide<2>(far, h)), Vector(highs.least()));
        double upper[5] = {highs.least()};
        h.store(upper + 1);
        const unsigned crossed = above(at_least(l), at_most(h));
        const int more = std::min(std::countr_zero(crossed | 16), n - m);
        high = upper[more];
        return m + more;
      }
      lows = all_lows;
      highs = all_highs;
    }
    high = highs.least();
    return m;
  }
};
