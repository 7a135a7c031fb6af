// A heater loop in the link's thread: each report of the sensor is checked and sets the power. So a
// short stall of the host affects neither control nor protection. If the link is lost, the board
// switches the heater off.
#pragma once
#include <algorithm>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "heat/controller.hpp"
#include "heat/converter.hpp"
#include "heat/curve.hpp"
#include "heat/protection.hpp"
#include "link/device.hpp"

namespace passo::wire {

// How the board samples a sensor. The board shuts down if `range_checks` samples in a row are
// outside minimum…maximum: a second protection below those of the host.
struct SensorQuery {
  uint32_t sample_ticks, sample_count, rest_ticks, minimum, maximum, range_checks;
};

// When a target is reached: the temperature has been within `window_c` for `seconds`. The time
// restarts if the temperature leaves the target by more than `leaves_c` (StuFW's rule, which is
// Marlin's). A heater that has been nearer than `leaves_c` for a minute has also arrived, so that a
// wait ends even if the last degree is never reached.
struct Arrival {
  double window_c = 1, leaves_c = 3, seconds = 10;
  static constexpr double kTimeout = 60;  // seconds
};

struct HeaterOptions {
  uint32_t sensor_oid, output_oid;
  bool pwm;           // queue_pwm_out, else queue_digital_out
  uint32_t full;      // value of full power: PWM_MAX, or the ticks of the software PWM's cycle
  uint32_t adc_full;  // a report of the sensor at the full scale of the ADC
  SensorQuery query;
  double longest_s;  // the board switches the power off if it is not renewed within this time
  double max_power;  // 0…1
  Arrival arrival;
  heat::Curve celsius;           // fraction of full scale → °C
  double low_share, high_share;  // beyond these the sensor is broken …
  bool open_is_high;             // true: open above high_share, shorted below low_share
  heat::Control control;
  heat::ProtectionLimits limits;
  std::optional<heat::HeatModel> model;  // thermal model of the body, if known
  int32_t fan_target = -1;               // pin of the job that cools the body; -1: none
  double fan_full = 1;                   // that pin's value at full speed
  bool inverted = false;                 // the output is on when low
  heat::Converter converter = heat::Converter::none;  // the converter that sends the reports,
                                                      // if there is one
  uint32_t spi_oid = 0;                               // of the converter
  Bytes clears_faults;  // clears a fault of the converter; empty: no command
  std::vector<std::pair<uint32_t, bool>> further;  // oids of outputs that switch with the first
                                                   // one, and whether they are on when low
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

  // Callers hold this lock while they use a heater whose link has a thread.
  std::mutex& guard() { return guard_; }
  const HeaterOptions& options() const { return o_; }
  double celsius() const { return celsius_; }
  // The sensor's last report as a fraction of full scale; 0 before the first one.
  double fraction() const { return fraction_; }
  // The sensor has reported since the last loss of the link.
  bool connected() const { return clock_.has_value(); }
  // Board clock of the last report, also after a loss of the link.
  std::optional<Ticks> reported() const { return reported_; }
  double target() const { return target_; }
  double power() const { return power_; }
  const heat::Terms& terms() const { return controller_.terms(); }
  // True from the first report in the target's window on, until the target changes.
  bool reached() const { return reached_; }
  // The temperature has stayed in the window as long as `arrival` requires.
  bool settled() const;
  const Arrival& arrival() const { return o_.arrival; }
  // During a fault the target is kept, but the heater is off.
  void set_target(double celsius);
  // While suspended, the target is kept and may change, but the heater is off.
  void set_suspended(bool suspended) { suspended_ = suspended; }
  bool suspended() const { return suspended_; }

  // Sets another sensor on the same input, or other settings of it: table and range.
  void set_sensor(const HeaterOptions& other);

  const heat::Control& control() const { return controller_.control(); }
  void set_control(const heat::Control& control);
  // The model for the protections. Without a model they do not use one.
  void set_model(const std::optional<heat::HeatModel>& model);
  const std::optional<heat::Observer>& body() const { return body_; }
  const heat::ProtectionLimits& limits() const { return protection_.limits(); }
  void set_limits(const heat::ProtectionLimits& limits) { protection_.set(limits); }
  double fan() const { return fan_; }
  // The speed of the fan that cools this heater, 0…1, for its model.
  void set_fan(double speed) { fan_ = std::clamp(speed, 0.0, 1.0); }
  // The last value that the job has set for the fan; read when it is new.
  void follow_fan(uint32_t value);

  const heat::Fault& fault() const { return fault_; }
  bool faulty() const { return fault_.kind != heat::FaultKind::none; }
  // Returns true once after each fault.
  bool take_news() { return std::exchange(news_, false); }
  // Ends a fault: the heater heats again, to its kept target.
  void rearm();

  // The board has run without the host, with at most the power that keeps the heater warm.
  void interrupted();
  // The mean fraction of power that has held the target recently; 0 until the target was reached,
  // and for a faulty heater.
  double keeping() const { return reached_ && !faulty() ? keeping_ : 0; }

  std::deque<HeatSample>& samples() { return samples_; }

  // Takes a report (sum of samples) of board clock `clock`; returns true if `value` must be sent.
  bool report(uint32_t sum, Ticks clock, double clock_hz, uint32_t& value);

  // The board was queried again, with the range of the sensor.
  void asked_anew() { wide_ = false; }
  // Without a fault, the board watches the sensor's range. For a heater that is off this is not
  // necessary, and the board must not stop the machine for it. Returns true if the query must be
  // sent again: with `wide`, or with the sensor's range.
  bool change_net(bool& wide);

 private:
  static constexpr double kKeepingSeconds = 20;  // averaging time of the power
  static constexpr size_t kSamplesMax = 4096;
  static constexpr double kFullShare = 0.95;  // fraction of maximum power that counts as full

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
  std::optional<double> near_s_;  // time in the window
  double about_s_ = 0;            // time nearer to the target than leaves_c
  double off_ = 0;                // distance from the target at the last report; 0: no report
  bool reached_ = false, news_ = false, wide_ = false, new_net_ = false, suspended_ = false;

  void leave();
  void arrive(double target, double dt);
  // A relay oscillates around its target, so the target serves only to check the heating phase.
  double heating_target() const;
};

}  // namespace passo::wire
