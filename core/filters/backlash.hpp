// Backlash compensation of one motor. Its drive has a gap: after a turn the motor must move by the
// gap before the carriage follows.
#pragma once
#include <algorithm>
#include <cmath>
#include <deque>
#include <utility>

namespace passo {

// The motor's position is q + lead, where q is its filtered law. The lead is 0 after enough motion
// in negative direction, and the gap after enough motion in positive direction. After a turn it
// changes in proportion to the distance, and is complete after `over` steps. So a quadratic stays a
// quadratic, with one more breakpoint. A motor that turns again before `over` takes back what it
// has added. The gap is a whole number of steps, so that a complete lead does not change how
// positions are rounded.
class Backlash {
 public:
  // Sets gap and distance, in steps of the motor. The lead keeps its fraction of the gap. Call this
  // only at standstill.
  void set(double gap, double over) {
    gap = std::floor(gap + 0.5);
    if (gap == gap_ && over == over_) return;
    const double part = gap_ > 0 ? lead_ / gap_ : 0;
    gap_ = gap, over_ = over, per_ = gap > 0 ? gap / over : 0;
    lead_ = part * gap;
  }
  bool on() const { return gap_ > 0; }
  double lead() const { return lead_; }
  // The drive rests as after motion in this direction. Call this only at standstill.
  void lean(int dir) { rest_with(lead_after(dir)); }
  void rest_with(double lead) { lead_ = lead; }
  double lead_after(int dir) const { return dir > 0 ? gap_ : 0; }

  // Motion starts at clock t and position q. There may have been motion without filters before.
  void begin(double t, double q) {
    t_ = t, q_ = q;
    turn(0);
  }
  // Motion ends with the last interval.
  void rest() {
    if (dir_ != 0) turn(0);
  }
  // Motion continues at clock t and position q, as the law `of` has it there. `of` may be this law.
  void resume(double t, double q, const Backlash& of) {
    lead_ = of.lead_at(t, q);
    cut(t, of);
    begin(t, q);
  }
  // The same as resume(), at standstill.
  void stand(double t, const Backlash& of) {
    lead_ = of.t_ <= t ? of.lead_ : of.before(t).lead;
    cut(t, of);
  }
  // Later calls of resume() have clocks from `past` on.
  void forget(double past) {
    while (turns_.size() > 1 && turns_[1].at <= past) turns_.pop_front();
  }

  // Passes on an interval of the law, in parts. The sink is the one of Taps.
  template <class Sink>
  void pass(double t, double q, double v0, double v1, double a, Sink& sink) {
    if (v0 * v1 < 0) {
      const double u = -v0 / a;
      leg(std::min(t_ + u, t), q_ + 0.5 * v0 * u, v0, 0, a, sink);
      v0 = 0;
    }
    leg(t, q, v0, v1, a, sink);
  }
  // Passes on a cubic with these derivatives at its start. The sink is the one of SmoothLaw.
  template <class Sink>
  void pass_cubic(double t, double d, double q, double v, double a, double j, double end,
                  double end_speed, Sink& sink) {
    // The cubic turns at most twice.
    double turns[2] = {d, d};
    int n = 0;
    const double disc = a * a - 2 * j * v;
    if (disc > 0) {
      const double r = -(a + (a < 0 ? -std::sqrt(disc) : std::sqrt(disc)));
      double first = r / j, second = 2 * v / r;
      if (!(first <= second)) std::swap(first, second);
      if (first > 0 && first < d) turns[n++] = first;
      if (second > 0 && second < d) turns[n++] = second;
    }
    Cubic rest{t, d, q, v, a, j, end, end_speed};
    for (int i = 0; i < n; ++i) {
      const double u = t + turns[i] - rest.t;
      if (!(u > 0 && u < rest.d)) continue;
      Cubic first = rest.take(u);
      first.end_speed = rest.v = 0;
      leg(first, sink);
    }
    leg(rest, sink);
  }
  template <class Sink>
  struct Onto {
    Backlash& backlash;
    Sink& sink;
    void cubic(double t, double d, double q, double v, double a, double j, double end,
               double end_speed) {
      backlash.pass_cubic(t, d, q, v, a, j, end, end_speed, sink);
    }
    void add(double t, double q, double v0, double v1, double a) {
      backlash.pass(t, q, v0, v1, a, sink);
    }
    // Extruders, and motors that follow the nozzle, keep their lead.
    template <class... Parts>
    void bent(const Parts&... parts) {
      sink.bent(parts...);
    }
    template <class... Parts>
    void counted(const Parts&... parts) {
      sink.counted(parts...);
    }
    template <class Piece>
    void piece(const Piece& piece) {
      sink.piece(piece);
    }
  };

 private:
  struct Turn {
    double at, q, lead;
    int dir;  // direction of the motion that starts here; 0: standstill
  };
  double gap_ = 0, over_ = 0, per_ = 0;  // per_: change of the lead for each step of the law
  double t_ = 0, q_ = 0, lead_ = 0;      // end of the last interval: clock, position, lead
  int dir_ = 0;
  std::deque<Turn> turns_;  // between two of them the direction is the same

  struct Cubic {
    double t, d, q, v, a, j, end, end_speed;

    double travel(double u) const { return u * (v + u * (0.5 * a + u * (j * (1.0 / 6)))); }
    double speed(double u) const { return v + u * (a + 0.5 * u * j); }
    // Cuts off the first u ticks and returns them.
    Cubic take(double u) {
      const Cubic first{t, u, q, v, a, j, q + travel(u), speed(u)};
      *this = {t + u, d - u, first.end, first.end_speed, a + j * u, j, end, end_speed};
      return first;
    }
    // Ticks after which the cubic has moved by this distance in direction `dir`.
    double after(double distance, int dir) const {
      double low = 0, high = d;
      for (int i = 0; i < 60; ++i) {
        const double middle = 0.5 * (low + high);
        (travel(middle) * dir < distance ? low : high) = middle;
      }
      return high;
    }
  };

  void turn(int dir) {
    turns_.push_back({t_, q_, lead_, dir});
    dir_ = dir;
  }
  Turn before(double t) const {
    for (auto turn = turns_.rbegin(); turn != turns_.rend(); ++turn)
      if (turn->at <= t) return *turn;
    if (turns_.empty()) return {t, q_, lead_, 0};
    return {t, turns_.front().q, turns_.front().lead, 0};  // standstill before the first turn
  }
  double lead_at(double t, double q) const {
    const Turn turn = before(t);
    if (turn.dir == 0) return turn.lead;
    const double distance = std::max((q - turn.q) * turn.dir, 0.0);
    return std::min(std::max(turn.lead + turn.dir * per_ * distance, 0.0), gap_);
  }
  void cut(double t, const Backlash& of) {
    if (&of != this) turns_.clear();
    while (!turns_.empty() && turns_.back().at > t) turns_.pop_back();
  }
  // Passes on a part in which the motor moves in one direction.
  template <class Sink>
  void leg(Cubic c, Sink& sink) {
    const int dir = c.end > c.q ? 1 : c.end < c.q ? -1 : 0;
    const bool stands = c.v == 0 && c.a == 0 && c.j == 0;
    if (stands ? dir_ != 0 : dir != 0 && dir != dir_) turn(stands ? 0 : dir);
    const double left = dir > 0 ? gap_ - lead_ : dir < 0 ? lead_ : 0;
    if (left > 0) {
      const double distance = std::fabs(c.end - c.q), all = left / per_, faster = 1 + per_;
      Cubic first = distance > all ? c.take(c.after(all, dir)) : c;
      const double before = lead_;
      lead_ = distance > all ? lead_after(dir)
                             : std::min(std::max(lead_ + dir * per_ * distance, 0.0), gap_);
      sink.cubic(first.t, first.d, first.q + before, faster * first.v, faster * first.a,
                 faster * first.j, first.end + lead_, faster * first.end_speed);
      if (!(distance > all)) return close(c);
    }
    sink.cubic(c.t, c.d, c.q + lead_, c.v, c.a, c.j, c.end + lead_, c.end_speed);
    close(c);
  }
  void close(const Cubic& c) { t_ = c.t + c.d, q_ = c.end; }
  template <class Sink>
  void leg(double t, double q, double v0, double v1, double a, Sink& sink) {
    const int dir = v0 + v1 > 0 ? 1 : v0 + v1 < 0 ? -1 : 0;
    if (dir != dir_) turn(dir);
    const double left = dir > 0 ? gap_ - lead_ : dir < 0 ? lead_ : 0;
    if (left > 0) {
      const double distance = std::max((q - q_) * dir, 0.0), all = left / per_, faster = 1 + per_;
      if (distance <= all) {
        lead_ = std::min(std::max(lead_ + dir * per_ * distance, 0.0), gap_);
        v0 *= faster, v1 *= faster, a *= faster;
      } else {
        const double root = v0 * v0 + 2 * a * dir * all;
        const double u = 2 * all / (std::fabs(v0) + std::sqrt(std::max(root, 0.0)));
        const double speed = dir * std::max((v0 + a * u) * dir, 0.0);
        lead_ = lead_after(dir);
        sink.add(std::min(t_ + u, t), q_ + dir * all + lead_, faster * v0, faster * speed,
                 faster * a);
        v0 = speed;
      }
    }
    sink.add(t, q + lead_, v0, v1, a);
    t_ = t, q_ = q;
  }
};

}  // namespace passo
