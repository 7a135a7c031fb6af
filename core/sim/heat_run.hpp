// A heater loop and the body that it heats, without a board between them. Plans use it to predict
// how long heating takes. Control, arrival and body are those of a simulated printer.
#pragma once
#include <cstdint>

#include "link/heater.hpp"
#include "sim/plant.hpp"

namespace passo::wire {

class HeatRun {
 public:
  // The options' table maps fractions of full scale to °C, the body's °C to fractions.
  HeatRun(HeaterOptions options, HeatedBody body);
  Heater& heater() { return heater_; }

  // Sets the speed of the fan that cools the body, 0 to 1.
  void set_fan(double speed);
  // Lets time pass, to the millisecond.
  void run(double seconds);

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
