// Thermocouple and RTD interfaces on an SPI bus, read at regular times. Words outside their range,
// or with a fault, several times in a row shut the board down, and with it every heater. A range of
// all words watches neither.
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
  uint8_t max_faults, faults;  // in a row
  uint8_t type;
  volatile bool due;
};
