// A heater loop with the body that it heats, without a board. Plans use it to predict how long
// heating takes. Control and body are the same as in a simulated printer.
#pragma once
#include <cstdint>

#include "link/heater.hpp"
#include "sim/plant.hpp"

namespace passo::wire {

class HeatRun {
 public:
  // The table of `options` converts fractions of full scale to °C. The table of `body` does the
  // reverse.
  HeatRun(HeaterOptions options, HeatedBody body);
  Heater& heater() { return heater_; }

  // Sets the speed of the fan that cools the body, 0 to 1.
  void set_fan(double speed);
  // Lets time pass, with a resolution of 1 ms.
  void run(double seconds);

 private:
  static constexpr double kHz = 1000;
  static constexpr Ticks kReportTicks = 250;
  static constexpr uint32_t kHeaterPin = 1, kSensorPin = 2, kFanPin = 3;

  Heater heater_;
  Plant plant_;
  Ticks now_ = 0, next_ = 0;
  double rest_ = 0;  // fraction of a tick
};

}  // namespace passo::wire
