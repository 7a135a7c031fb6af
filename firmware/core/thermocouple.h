// Thermocouple and RTD interfaces on an SPI bus, read at regular times. If several values in a row
// are out of range or have a fault, the board shuts down, and with it every heater. A range of all
// values switches this check off.
#pragma once
#include <stdbool.h>
#include <stdint.h>

#include "object.h"
#include "scheduler.h"
#include "spi.h"

struct thermocouple {
  struct object object;
  struct timer timer;
  const struct spi *spi;
  uint32_t rest_ticks, minimum, maximum;
  uint8_t max_faults, faults;  // number of faults in a row
  uint8_t type;
  volatile bool due;
};
