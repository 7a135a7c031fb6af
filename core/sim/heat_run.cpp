#include "sim/heat_run.hpp"

#include <algorithm>
#include <cstdint>
#include <utility>

namespace passo::wire {

HeatRun::HeatRun(HeaterOptions options, HeatedBody body)
    : heater_(std::move(options)), plant_(kHz, heater_.options().adc_full, 0) {
  body.heater_pin = kHeaterPin;
  body.sensor_pin = kSensorPin;
  body.fan_pin = kFanPin;
  plant_.add_body(std::move(body));
}

void HeatRun::set_fan(double speed) {
  heater_.set_fan(speed);
  plant_.set_output(kFanPin, now_, std::clamp(speed, 0.0, 1.0));
}

void HeatRun::run(double seconds) {
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

}  // namespace passo::wire
