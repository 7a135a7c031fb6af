// A laser whose power follows the speed of the head, so that each millimetre gets the same energy.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "plan/move.hpp"

namespace passo {

// Calls value_at(ticks, mean) for consecutive parts of a move. `mean` is the mean path speed from
// `ticks` to the next call, in units of the path measure per second. Ramps are divided into equal
// parts of at most kLaserSlice seconds. Constant speed is one part.
inline constexpr double kLaserSlice = 0.005;

template <class F>
void each_speed(const Move& m, double hz, F value_at) {
  auto ramp = [&](double from, double ticks, double speed, double change) {
    if (ticks <= 0) return;
    double n = std::max(1.0, std::ceil(ticks / (kLaserSlice * hz)));
    for (double k = 0; k < n; ++k)
      value_at(from + ticks * k / n,
               std::max(0.0, speed + change * (ticks / hz) * ((k + 0.5) / n)));
  };
  ramp(m.start, m.t_acc, m.v0, m.a);
  if (m.t_cru > 0) value_at(m.start + m.t_acc, m.vc);
  ramp(m.start + m.t_acc + m.t_cru, m.t_dec, m.vc, -m.b);
}

// The power of a laser. A move sets the power in proportion to its speed; a record sets it
// directly.
class LaserLight {
 public:
  static constexpr uint16_t kNone = 0x7fff;  // not the number of any output

  uint16_t target() const { return target_; }
  // Output `target` is the laser; `full` is its value for full power.
  void set(uint16_t target, uint32_t full) {
    target_ = target;
    full_ = full;
  }
  // From now on records set the laser's power, not moves.
  void recorded() { follows_ = false; }
  // Calls put(ticks, value) for each change of the value along a move. The laser goes off before a
  // move without power.
  template <class Put>
  void follow(const Move& m, double hz, Put&& put) {
    if (m.duty == 0) return off(m.start, put);
    if (m.kind == MoveKind::dwell) return change(m.start, m.duty, put);
    double mm2 = 0, longest = 0;
    for (int j = 0; j < kAxes; ++j) {
      double mm = std::fabs(m.p1[j] - m.p0[j]);
      longest = std::max(longest, mm);
      if (j <= kZ) mm2 += mm * mm;
    }
    double duty = m.duty * (m.cartesian ? std::sqrt(mm2) : longest) / m.d;
    each_speed(m, hz, [&](double ticks, double speed) { change(ticks, duty * speed, put); });
  }
  // Switches the laser off if a move has set its power.
  template <class Put>
  void off(double ticks, Put&& put) {
    if (follows_) change(ticks, 0, put);
    follows_ = false;
  }
  // After a cut: whether a move sets the power from now on. The last value is unknown.
  void cut(bool follows) {
    follows_ = follows;
    value_ = full_ + 1;
  }

 private:
  uint16_t target_ = kNone;
  uint32_t full_ = 0, value_ = 0;  // value_: the last value set by a move
  bool follows_ = false;           // moves set the power, not records

  template <class Put>
  void change(double ticks, double share, Put&& put) {
    uint32_t value = uint32_t(std::min(1.0, share) * full_ + 0.5);
    if (follows_ && value == value_) return;
    follows_ = true;
    value_ = value;
    put(ticks, value);
  }
};

}  // namespace passo
