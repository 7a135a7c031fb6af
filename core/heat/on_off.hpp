// On/off control: full power below the target, no power above it, with a minimum time between
// switchings.
#pragma once
#include "heat/reading.hpp"

namespace passo::heat {

struct OnOffControl {
  double hysteresis_c = 1;  // distance from the target at which it switches
  double interval_s = 0;    // minimum time between two switchings
  bool operator==(const OnOffControl&) const = default;
};

class OnOff {
 public:
  explicit OnOff(const OnOffControl& options) : o_(options) {}
  void set(const OnOffControl& options) { o_ = options; }
  const Terms& terms() const { return terms_; }

  double update(const Reading& r) {
    since_ += r.dt;
    double error = r.target - r.celsius;
    if (r.target <= 0) {
      // A target of 0 switches off at once. The next switching on does not wait.
      on_ = false;
      since_ = o_.interval_s;
      terms_ = {};
      return 0;
    }
    bool wanted = on_ ? error > -o_.hysteresis_c : error > o_.hysteresis_c;
    if (wanted != on_ && (since_ >= o_.interval_s || r.dt == 0)) {
      on_ = wanted;
      since_ = 0;
    }
    double output = on_ ? r.max_power : 0;
    terms_ = {error, output, 0, 0, output};
    return output;
  }

 private:
  OnOffControl o_;
  bool on_ = false;
  double since_ = 1e9;
  Terms terms_;
};

}  // namespace passo::heat
