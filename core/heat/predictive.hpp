// Model-predictive control: the power with which the estimated temperature of the body reaches the
// target within a short horizon.
#pragma once
#include <algorithm>

#include "heat/observer.hpp"
#include "heat/reading.hpp"

namespace passo::heat {

struct ModelControl {
  HeatModel model;
  double horizon_s = 3;
  bool operator==(const ModelControl&) const = default;
};

class Predictive {
 public:
  explicit Predictive(const ModelControl& options) : o_(options) {}
  void set(const ModelControl& options) { o_ = options; }
  const Terms& terms() const { return terms_; }

  // Requires `r.body`. In the terms, i is the power that holds the target, and p the power for the
  // difference from the target.
  double update(const Reading& r) {
    if (r.target <= 0 || !r.body) {
      terms_ = {};
      return 0;
    }
    const HeatModel& m = r.body->model();
    double gap = r.target - r.body->body_c();
    double p = gap * m.time_constant_s / (o_.horizon_s * m.rise_c);
    double i = r.body->holding(r.target);
    double output = std::clamp(p + i, 0.0, r.max_power);
    terms_ = {r.target - r.celsius, p, i, 0, output};
    return output;
  }

 private:
  ModelControl o_;
  Terms terms_;
};

}  // namespace passo::heat
