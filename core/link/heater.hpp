// A heater loop in the link's thread: each report of the sensor is checked and sets the power
// again. So a short stall of the host affects neither control nor protection, and if the link is
// lost the board switches the heater off.
#pragma once
#include <algorithm>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <utility>

#include "heat/controller.hpp"
#include "heat/converter.hpp"
#include "heat/curve.hpp"
#include "heat/protection.hpp"
#include "link/device.hpp"

namespace passo::wire {

// How the board samples a sensor. Outside minimum…maximum, `range_checks` times in a row, it shuts
// down: the net below the host's own protections.
struct SensorQuery {
  uint32_t sample_ticks, sample_count, rest_ticks, minimum, maximum, range_checks;
};

// When a target is reached: within `window_c`, for so many seconds. They restart if the temperature
// leaves the target by more than `leaves_c` (StuFW's rule, which is Marlin's). So that a wait ends
// even if the last degree is never reached: a heater that has been nearer than `leaves_c` for a
// minute has arrived.
struct Arrival {
  double window_c = 1, leaves_c = 3, seconds = 10;
  static constexpr double kTimeout = 60;  // seconds
};

struct HeaterOptions {
  uint32_t sensor_oid, output_oid;
  bool pwm;           // queue_pwm_out, else queue_digital_out
  uint32_t full;      // value of full power: PWM_MAX, or the ticks of the software PWM's cycle
  uint32_t adc_full;  // a report of the sensor at the ADC's full scale
  SensorQuery query;
  double longest_s;  // the board switches the power off if it is not renewed within this time
  double max_power;  // 0…1
  Arrival arrival;
  heat::Curve celsius;           // fraction of full scale → °C
  double low_share, high_share;  // beyond them the sensor is broken …
  bool open_is_high;             // … and open above the one, shorted below the other, or vice versa
  heat::Control control;
  heat::ProtectionLimits limits;
  std::optional<heat::HeatModel> model;  // of the body, where it is known
  int32_t fan_target = -1;               // pin of the job that cools the body; -1: none
  double fan_full = 1;                   // that pin's value at full speed
  bool inverted = false;                 // the output is on when low
  heat::Converter converter = heat::Converter::none;  // the converter that the reports come from,
                                                      // if any
  uint32_t spi_oid = 0;                               // of the converter
  Bytes clears_faults;  // the command that clears a fault of the converter, or nothing
};

// The input and output of the loop for one report.
struct HeatSample {
  Ticks clock;
  double celsius, target, power;
  heat::Terms terms;
};

class Heater {
 public:
  explicit Heater(HeaterOptions options);

  // A lock that callers hold while they use a heater whose link has a thread.
  std::mutex& guard() { return guard_; }
  const HeaterOptions& options() const { return o_; }
  double celsius() const { return celsius_; }
  // The sensor's last report as a fraction of full scale; 0 before the first one.
  double fraction() const { return fraction_; }
  // The sensor has reported, and the link has not been lost since.
  bool heard() const { return clock_.has_value(); }
  // Board clock of the last report, also if the link has been lost since.
  std::optional<Ticks> reported() const { return reported_; }
  double target() const { return target_; }
  double power() const { return power_; }
  const heat::Terms& terms() const { return controller_.terms(); }
  // True from the first report in the target's window on, until the target changes.
  bool reached() const { return reached_; }
  // It has stayed there for as long as `arrival` requires.
  bool settled() const;
  const Arrival& arrival() const { return o_.arrival; }
  // While there is a fault the target is kept, but nothing heats.
  void set_target(double celsius);
  // While it is suspended the target is kept, and may change, but nothing heats.
  void set_suspended(bool suspended) { suspended_ = suspended; }
  bool suspended() const { return suspended_; }

  // Another sensor on the same input, or other settings of it: its table and its range.
  void set_sensor(const HeaterOptions& other);

  const heat::Control& control() const { return controller_.control(); }
  void set_control(const heat::Control& control);
  // For the protections; without one they do without.
  void set_model(const std::optional<heat::HeatModel>& model);
  const std::optional<heat::Observer>& body() const { return body_; }
  const heat::ProtectionLimits& limits() const { return protection_.limits(); }
  void set_limits(const heat::ProtectionLimits& limits) { protection_.set(limits); }
  double fan() const { return fan_; }
  // The speed of the fan that cools this heater, 0…1, for its model.
  void set_fan(double speed) { fan_ = std::clamp(speed, 0.0, 1.0); }
  // The last value that the job has set for the fan; it counts when it is new.
  void follow_fan(uint32_t value);

  const heat::Fault& fault() const { return fault_; }
  bool faulty() const { return fault_.kind != heat::FaultKind::none; }
  // True once after each fault.
  bool take_news() { return std::exchange(news_, false); }
  // Lets a faulty heater heat again, to the target that it kept.
  void rearm();

  // The board has run without the host, with at most the power that keeps the heater warm.
  void interrupted();
  // The mean fraction of power that has held the target recently; 0 until the target was reached,
  // and for a faulty heater.
  double keeping() const { return reached_ && !faulty() ? keeping_ : 0; }

  std::deque<HeatSample>& samples() { return samples_; }

  // Takes a report (sum of samples) made at board clock `clock`; true if `value` must be sent.
  bool report(uint32_t sum, Ticks clock, double clock_hz, uint32_t& value);

  // The board was queried again, with the sensor's own range.
  void asked_anew() { wide_ = false; }
  // While there is no fault, the board watches the sensor's range. A heater that is off does not
  // need that any more, and the board must not stop the whole machine for it. Returns true if the
  // query must be sent again, with `wide` or with its own range.
  bool change_net(bool& wide);

 private:
  static constexpr double kKeepingSeconds = 20;  // over which the power is averaged
  static constexpr size_t kSamplesMax = 4096;
  static constexpr double kFullShare = 0.95;  // of maximum power: counts as full

  std::mutex guard_;
  HeaterOptions o_;
  heat::Controller controller_;
  heat::Protection protection_;
  std::optional<heat::Observer> body_;
  heat::Fault fault_;
  std::deque<HeatSample> samples_;
  double target_ = 0, celsius_ = 0, fraction_ = 0, power_ = 0, fan_ = 0, keeping_ = 0;
  uint32_t fan_value_ = 0;
  std::optional<Ticks> clock_;  // of the last report, unless interrupted since
  std::optional<Ticks> reported_;
  std::optional<double> near_s_;  // time within its window
  double about_s_ = 0;            // time nearer to the target than leaves_c
  double off_ = 0;                // from its target, with the last report; 0 if there was none
  bool reached_ = false, news_ = false, wide_ = false, new_net_ = false, suspended_ = false;

  void leave();
  void arrive(double target, double dt);
  // A relay oscillates around its target, so the target serves only to check the heating phase.
  double heating_target() const;
};

}  // namespace passo::wire
