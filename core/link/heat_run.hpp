// A heater loop and the body that it heats, without a board between them: how long heating takes,
// for plans. Control, arrival and body are those of a simulated printer.
#pragma once
#include <algorithm>

#include "link/heater.hpp"
#include "sim/plant.hpp"

namespace passo::wire {

class HeatRun {
 public:
  // The options' table leads from shares of full scale to °C; the body's from °C to shares.
  HeatRun(HeaterOptions options, HeatedBody body)
      : heater_(std::move(options)), plant_(kHz, heater_.options().adc_full, 0) {
    body.heater_pin = kHeaterPin;
    body.sensor_pin = kSensorPin;
    body.fan_pin = kFanPin;
    plant_.add_body(std::move(body));
  }
  Heater& heater() { return heater_; }

  // The fan that cools the body blows so fast from now on, 0 to 1.
  void set_fan(double speed) {
    heater_.set_fan(speed);
    plant_.set_output(kFanPin, now_, std::clamp(speed, 0.0, 1.0));
  }
  // Lets time pass, to the millisecond.
  void run(double seconds) {
    rest_ += std::max(seconds, 0.0) * kHz;
    Ticks end = now_ + Ticks(rest_);
    rest_ -= double(end - now_);
    for (; next_ <= end; next_ += kReportTicks) {
      uint32_t value = 0;
      heater_.report(plant_.adc(kSensorPin, next_), next_, kHz, value);
      plant_.set_output(kHeaterPin, next_, heater_.power());
    }
    now_ = end;
  }

 private:
  static constexpr double kHz = 1000;
  static constexpr Ticks kReportTicks = 250;
  static constexpr uint32_t kHeaterPin = 1, kSensorPin = 2, kFanPin = 3;

  Heater heater_;
  Plant plant_;
  Ticks now_ = 0, next_ = 0;
  double rest_ = 0;  // of a tick
};

}  // namespace passo::wire
