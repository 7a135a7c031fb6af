// A canned cycle (G73, G81, G82, G83) as straight moves and dwells, in machine coordinates.
#pragma once
#include <algorithm>

#include "base/types.hpp"

namespace passo {

// One line of a cycle drills `repeats` holes. A rapid move in the plane of slots u and v goes to
// each hole, and slot w drills it. next() calculates one move at a time, so that many holes need no
// memory.
class Cycle {
 public:
  static constexpr double kBackOffMm = 0.254;  // retraction between pecks, as in RS274
  static constexpr double kMaxRepeats = 10'000, kMaxPecks = 1e6;

  struct Plan {
    int code = 81;
    int u = 0, v = 1, w = 2;
    double at[2] = {}, by[2] = {};  // of the first hole, and the distance to the next hole
    double start = 0, bottom = 0, clear = 0;  // level R, bottom of the hole, level between holes
    double peck = 0, dwell_s = 0;
    int repeats = 0;
  };
  struct Step {
    double target[3];
    bool rapid;
    double dwell_s;  // if above 0, the step is a dwell
    uint8_t moved;   // a bit for each slot
  };

  Cycle() = default;
  explicit Cycle(const Plan& plan) : plan_(plan) {}
  bool active() const { return hole_ < plan_.repeats; }
  // Shifts the remaining part of the cycle along slot j.
  void shift(int j, double mm) {
    if (j == plan_.u) plan_.at[0] += mm;
    if (j == plan_.v) plan_.at[1] += mm;
    if (j != plan_.w) return;
    plan_.start += mm;
    plan_.bottom += mm;
    plan_.clear += mm;
    depth_ += mm;
  }
  // The next step from `position`. Its distance may be 0.
  Step next(const double* position) {
    Step step{{position[0], position[1], position[2]}, true, 0, 0};
    auto along = [&](double to, bool rapid, Phase then) {
      step.target[plan_.w] = to;
      step.moved = uint8_t(1u << plan_.w);
      step.rapid = rapid;
      phase_ = then;
    };
    switch (phase_) {
      case Phase::lift:  // no move across below level R
        along(std::max(position[plan_.w], plan_.start), true, Phase::across);
        break;
      case Phase::across:
        step.target[plan_.u] = plan_.at[0] + hole_ * plan_.by[0];
        step.target[plan_.v] = plan_.at[1] + hole_ * plan_.by[1];
        step.moved = uint8_t(1u << plan_.u | 1u << plan_.v);
        phase_ = Phase::approach;
        depth_ = plan_.start;
        break;
      case Phase::approach:
        along(plan_.start, true, Phase::feed);
        break;
      case Phase::feed:
        depth_ = plan_.peck > 0 ? std::max(plan_.bottom, depth_ - plan_.peck) : plan_.bottom;
        along(depth_, false,
              depth_ > plan_.bottom ? Phase::clear_chip
              : plan_.dwell_s > 0   ? Phase::dwell
                                    : Phase::retract);
        break;
      case Phase::clear_chip:
        if (plan_.code == 73)
          along(std::min(depth_ + kBackOffMm, plan_.start), true, Phase::feed);
        else
          along(plan_.start, true, Phase::back_in);
        break;
      case Phase::back_in:
        along(std::min(depth_ + kBackOffMm, plan_.start), true, Phase::feed);
        break;
      case Phase::dwell:
        step.dwell_s = plan_.dwell_s;
        phase_ = Phase::retract;
        break;
      case Phase::retract:
        along(plan_.clear, true, Phase::across);
        ++hole_;
        break;
    }
    return step;
  }

 private:
  enum class Phase : uint8_t { lift, across, approach, feed, clear_chip, back_in, dwell, retract };
  Plan plan_;
  Phase phase_ = Phase::lift;
  int hole_ = 0;
  double depth_ = 0;  // of the last peck
};

}  // namespace passo
