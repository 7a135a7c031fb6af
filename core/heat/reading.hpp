// The input of a controller with each report of the sensor, and the details of its answer.
#pragma once

namespace passo::heat {

class Observer;

struct Reading {
  double celsius, target;  // target ≤ 0: off
  double dt;               // seconds since the last reading; 0 with the first
  double max_power;        // 0…1
  const Observer* body;    // null where no model of the body is known
};

// Fractions of full power; error in °C.
struct Terms {
  double error = 0, p = 0, i = 0, d = 0, output = 0;
};

}  // namespace passo::heat
