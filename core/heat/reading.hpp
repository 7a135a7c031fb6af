// The input of a controller at each report of the sensor, and the terms of its result.
#pragma once

namespace passo::heat {

class Observer;

struct Reading {
  double celsius, target;  // target ≤ 0: off
  double dt;               // since the last reading, s; 0 for the first one
  double max_power;        // 0…1
  const Observer* body;    // null without a model of the body
};

// Fractions of full power; `error` is in °C.
struct Terms {
  double error = 0, p = 0, i = 0, d = 0, output = 0;
};

}  // namespace passo::heat
