// Divides the arcs of G2 and G3 into chords.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/numbers.hpp"
#include "base/types.hpp"

namespace passo {

// The middle of a chord is at most kChordError inside the circle. So the angle between two points
// is 2 acos(1 - kChordError/r), and acos(1 - x) ≥ sqrt(2x). The axis of a helix and the extruder
// move in proportion to the angle.
class Arc {
 public:
  static constexpr double kChordError = 0.0045;  // mm
  static constexpr double kMaxChords = 1e7;
  // Maximum difference of the radii at the two ends: a fraction of the larger radius, but at least
  // kMinSpiralMm and at most kMaxSpiralMm.
  static constexpr double kSpiral = 0.005, kMinSpiralMm = 0.05, kMaxSpiralMm = 0.5;
  static constexpr double kFullTurn = 6.283185307179586;

  // If the parameters of an arc define no circle, and its ends are this close together, it is a
  // straight line.
  static bool tiny(double mm) { return mm <= kMinSpiralMm; }

  bool active() const { return done_ < chords_; }

  // An arc from `start` to `end` in the plane of slots u, v, about the centre (cu, cv), plus
  // `turns` full circles. Returns false if the arc needs more than kMaxChords.
  bool begin(const double* start, const double* end, int u, int v, double cu, double cv,
             bool clockwise, int turns) {
    std::memcpy(start_, start, sizeof start_);
    std::memcpy(end_, end, sizeof end_);
    u_ = u;
    v_ = v;
    cu_ = cu;
    cv_ = cv;
    double au = start[u] - cu, av = start[v] - cv, bu = end[u] - cu, bv = end[v] - cv;
    radius0_ = std::sqrt(au * au + av * av);
    radius1_ = std::sqrt(bu * bu + bv * bv);
    angle_ = atan2(av, au);
    sweep_ = atan2(au * bv - av * bu, au * bu + av * bv);
    if (clockwise && sweep_ >= -1e-9) sweep_ -= kFullTurn;
    if (!clockwise && sweep_ <= 1e-9) sweep_ += kFullTurn;
    sweep_ += (clockwise ? -1 : 1) * kFullTurn * turns;
    double r = std::max(radius0_, radius1_);
    double step = 2 * std::sqrt(2 * std::min(kChordError / std::max(r, 1e-6), 0.1));
    most_turns_ = std::floor(kMaxChords * step / kFullTurn);
    double chords = std::ceil(std::fabs(sweep_) / step);
    if (chords > kMaxChords) return false;
    chords_ = std::max(1, int(chords));
    done_ = 0;
    reached_ = false;
    return true;
  }
  // Shifts the remaining part of the arc along slot j.
  void shift(int j, double mm) {
    start_[j] += mm;
    end_[j] += mm;
    if (j == u_) cu_ += mm;
    if (j == v_) cv_ += mm;
    reached_ = false;
  }
  // Remaining distance along slot j.
  double left(int j) const { return (end_[j] - start_[j]) * (1 - double(done_) / chords_); }
  // The remaining part starts at position `at` of slot j and covers `mm` there.
  void set_left(int j, double at, double mm) {
    end_[j] = at + mm;
    start_[j] = end_[j] - mm / (1 - double(done_) / chords_);
  }
  double most_turns() const { return most_turns_; }      // turns that begin() always accepts
  uint8_t axis() const { return uint8_t(3 - u_ - v_); }  // slot perpendicular to its plane
  double radius() const { return std::max(radius0_, radius1_); }
  double start_radius() const { return radius0_; }
  double end_radius() const { return radius1_; }
  // False if the two radii differ too much: then the centre is wrong. Rounded coordinates make only
  // a slight spiral.
  bool round() const {
    double allowed = std::clamp(kSpiral * radius(), kMinSpiralMm, kMaxSpiralMm);
    return std::fabs(radius1_ - radius0_) <= allowed;
  }
  bool first() const { return done_ == 1; }
  // Bounds of the whole circle along slot j of its plane. The arc itself may cover less.
  double lowest(int j) const { return (j == u_ ? cu_ : cv_) - radius(); }
  double highest(int j) const { return (j == u_ ? cu_ : cv_) + radius(); }
  // True if a check has found all remaining chords within reach of the actuators.
  bool reached() const { return reached_; }
  void note_reached() { reached_ = true; }

  // The end of the next chord.
  void next(double* point) {
    ++done_;
    if (done_ == chords_) {
      std::memcpy(point, end_, sizeof end_);
      return;
    }
    double part = double(done_) / chords_, s, c;
    sincos(angle_ + sweep_ * part, s, c);
    double r = radius0_ + (radius1_ - radius0_) * part;
    for (int j = 0; j < kAxes; ++j) point[j] = start_[j] + (end_[j] - start_[j]) * part;
    point[u_] = cu_ + r * c;
    point[v_] = cv_ + r * s;
  }

 private:
  double start_[kAxes], end_[kAxes];
  int u_ = 0, v_ = 1;
  double cu_ = 0, cv_ = 0, radius0_ = 0, radius1_ = 0, angle_ = 0, sweep_ = 0, most_turns_ = 0;
  int chords_ = 0, done_ = 0;
  bool reached_ = false;
};

}  // namespace passo
