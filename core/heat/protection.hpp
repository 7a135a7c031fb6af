// The protections of a heater. They are checked at each report of its sensor.
#pragma once
#include <algorithm>
#include <cstdint>
#include <utility>

namespace passo::heat {

enum class FaultKind : uint8_t {
  none,
  sensor_open,
  sensor_short,
  sensor_erratic,
  min_temperature,
  max_temperature,
  heating_failed,
  runaway,
  stuck_on,
  model_deviation,
};

// A limit of 0 switches off its protection, except min_c and max_c.
struct ProtectionLimits {
  double min_c = 5, max_c = 280;
  double jump_c = 10;  // between two reports; several jumps within seconds mean an erratic sensor
  double watch_rise_c = 2,
         watch_s = 20;  // maximum time for watch_rise_c at full power, while heating
  double runaway_c = 4,
         runaway_s = 40;  // after arrival: a fault if this much below the target for this long
  double stuck_on_c = 10,
         stuck_on_s = 60;  // while off: a fault if this much warmer within this time
  double deviation = 0.25, deviation_s = 30;  // unexplained fraction of full power, for this long
  bool operator==(const ProtectionLimits&) const = default;
};

struct Fault {
  FaultKind kind = FaultKind::none;
  double celsius = 0;  // the sensor's reading
  double limit = 0;    // the limit in °C; for a model deviation a fraction of full power
  int64_t clock = 0;
};

class Protection {
 public:
  struct Sight {
    double celsius, target,
        power;  // power: mean since the last report, as a fraction of full power
    double dt;
    bool full;  // the heater was at maximum power
    bool open, shorted;
    double unexplained;  // fraction of full power; 0 without a model
  };

  explicit Protection(const ProtectionLimits& limits) : o_(limits) {}
  void set(const ProtectionLimits& limits) { o_ = limits; }
  const ProtectionLimits& limits() const { return o_; }

  // Restarts as if the heater had just been switched on.
  void restart() { *this = Protection(o_); }

  // Reports were missing for a while, in which the body may have cooled. A heater that had reached
  // its target is heating again. A heater that was still heating keeps its deadline, and its goal
  // must be within reach of the present temperature. Without this rule, a heater that never gets
  // warmer would pass each time the link is lost.
  void interrupted() {
    known_ = false;
    resumes_ = true;
  }

  // Returns a fault and its limit; kind none if all is well.
  Fault check(const Sight& s) {
    time_ += s.dt;
    Fault fault = range(s);
    if (outside_ > 0)
      return reported(fault, s);  // this reading is not a temperature; the next report decides
    if (fault.kind == FaultKind::none) fault = jumps(s);
    if (fault.kind == FaultKind::none) fault = way_up(s);
    if (fault.kind == FaultKind::none) fault = switched_off(s);
    if (fault.kind == FaultKind::none) fault = deviation(s);
    return reported(fault, s);
  }

 private:
  static constexpr int kReports =
      2;  // number of consecutive reports outside the range that are a fault
  static constexpr double kJumps =
      3.5;  // number of jumps that are a fault; each is forgotten after kJumpSeconds
  static constexpr double kJumpSeconds = 10;
  static constexpr double kSettleSeconds = 10;  // heat may still be on its way to the sensor

  ProtectionLimits o_;
  double time_ = 0, before_ = 0;
  bool known_ = false;
  int outside_ = 0;
  double jumps_ = 0;
  double target_ = 0;  // the fields below are for this target
  bool arrived_ = false, resumes_ = false;
  double goal_ = 0, deadline_ = 0;
  double off_since_ = 0, coldest_ = 0, coldest_at_ = 0;
  double deviating_since_ = 0;

  Fault reported(Fault fault, const Sight& s) {
    fault.celsius = s.celsius;
    before_ = s.celsius;
    known_ = true;
    return fault;
  }
  Fault range(const Sight& s) {
    Fault fault;
    if (s.open)
      fault.kind = FaultKind::sensor_open;
    else if (s.shorted)
      fault.kind = FaultKind::sensor_short;
    else if (s.celsius < o_.min_c)
      fault.kind = FaultKind::min_temperature;
    else if (s.celsius > o_.max_c)
      fault.kind = FaultKind::max_temperature;
    if (fault.kind == FaultKind::none) {
      outside_ = 0;
      return fault;
    }
    bool cold = fault.kind == FaultKind::min_temperature || fault.kind == FaultKind::sensor_open;
    fault.limit = cold ? o_.min_c : o_.max_c;
    return ++outside_ >= kReports ? fault : Fault{};
  }
  Fault jumps(const Sight& s) {
    jumps_ = std::max(0.0, jumps_ - s.dt / kJumpSeconds);
    double jump = s.celsius - before_;
    if (known_ && o_.jump_c > 0 && (jump > o_.jump_c || jump < -o_.jump_c)) jumps_ += 1;
    return jumps_ >= kJumps ? Fault{FaultKind::sensor_erratic, 0, o_.jump_c} : Fault{};
  }
  Fault way_up(const Sight& s) {
    bool resumes = std::exchange(resumes_, false);
    if (s.target != target_ || (resumes && arrived_)) {
      target_ = s.target;
      arrived_ = false;
      aim(s.celsius);
    }
    if (resumes) goal_ = std::min(goal_, s.celsius + o_.watch_rise_c);
    if (s.target <= 0) return {};
    double least = s.target - o_.runaway_c;
    if (s.celsius >= least) {
      arrived_ = true;
      deadline_ = time_ + o_.runaway_s;
      return {};
    }
    if (arrived_) {
      if (o_.runaway_c <= 0 || time_ <= deadline_) return {};
      return {FaultKind::runaway, 0, least};
    }
    // At less than full power, the controller does not expect a rise.
    if (!s.full || s.celsius >= goal_) aim(s.celsius);
    if (o_.watch_rise_c <= 0 || time_ <= deadline_) return {};
    return {FaultKind::heating_failed, 0, goal_};
  }
  void aim(double celsius) {
    goal_ = celsius + o_.watch_rise_c;
    deadline_ = time_ + o_.watch_s;
  }
  Fault switched_off(const Sight& s) {
    if (s.power > 0) off_since_ = time_;
    bool settling = time_ - off_since_ < kSettleSeconds;
    if (settling || s.celsius < coldest_ || time_ - coldest_at_ > o_.stuck_on_s) {
      coldest_ = s.celsius;
      coldest_at_ = time_;
    }
    double most = coldest_ + o_.stuck_on_c;
    if (o_.stuck_on_c <= 0 || s.celsius <= most) return {};
    return {FaultKind::stuck_on, 0, most};
  }
  Fault deviation(const Sight& s) {
    bool within = s.unexplained >= -o_.deviation && s.unexplained <= o_.deviation;
    if (o_.deviation <= 0 || within) deviating_since_ = time_;
    if (time_ - deviating_since_ <= o_.deviation_s) return {};
    return {FaultKind::model_deviation, 0, o_.deviation};
  }
};

}  // namespace passo::heat
