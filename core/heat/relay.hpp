// Relay control for autotuning: the power alternates between two levels around the target. Their
// mean is adjusted until heating and cooling take equally long.
#pragma once
#include <algorithm>

#include "heat/reading.hpp"

namespace passo::heat {

struct RelayControl {
  double half_cycle_s = 5;  // minimum duration of each half cycle
  double band_c = 0;        // switches this far above and below the target
  bool operator==(const RelayControl&) const = default;
};

class Relay {
 public:
  explicit Relay(const RelayControl& options) : o_(options) {}
  void set(const RelayControl& options) { o_ = options; }
  const Terms& terms() const { return terms_; }

  double update(const Reading& r) {
    if (r.target <= 0) {
      *this = Relay(o_);
      return 0;
    }
    time_ += r.dt;
    if (!started_) {
      bias_ = swing_ = r.max_power / 2;
      started_ = heating_ = true;
      raised_ = time_ - o_.half_cycle_s;
    }
    if (heating_ && r.celsius > r.target + o_.band_c && time_ - raised_ >= o_.half_cycle_s) {
      heating_ = false;
      high_s_ = time_ - raised_;
      lowered_ = time_;
    } else if (!heating_ && r.celsius < r.target - o_.band_c &&
               time_ - lowered_ >= o_.half_cycle_s) {
      heating_ = true;
      if (cycles_++ > 0) balance(time_ - lowered_, r.max_power);
      raised_ = time_;
    }
    double output = bias_ + (heating_ ? swing_ : -swing_);
    terms_ = {r.target - r.celsius, bias_, 0, heating_ ? swing_ : -swing_, output};
    return output;
  }

 private:
  static constexpr double kMinBias =
      20.0 / 255;  // minimum distance of the mean from 0 and from full power, as a fraction

  RelayControl o_;
  double bias_ = 0, swing_ = 0;
  double time_ = 0, raised_ = 0, lowered_ = 0, high_s_ = 0;
  int cycles_ = 0;
  bool started_ = false, heating_ = false;
  Terms terms_;

  void balance(double low_s, double max_power) {
    double least = kMinBias * max_power;
    bias_ += swing_ * (high_s_ - low_s) / (high_s_ + low_s);
    bias_ = std::clamp(bias_, least, max_power - least);
    swing_ = bias_ > max_power / 2 ? max_power - bias_ : bias_;
  }
};

}  // namespace passo::heat
