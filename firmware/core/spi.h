// SPI over any pins, by software: for drivers of motors and for sensors that are asked now and
// then.
#pragma once
#include <stdbool.h>
#include <stdint.h>

#include "frame.h"
#include "hal.h"
#include "object.h"

struct spi {
  struct object object;
  struct hal_output select, clock, to_device;
  struct hal_input from_device;
  uint16_t pulse_ticks;  // half a bit, at least
  bool has_select, select_level, has_bus;
  bool clock_rest;    // level of the clock between transfers (CPOL)
  bool second_phase;  // data are taken at the clock's second edge (CPHA)
};

// The bytes that are sent when the board shuts down.
struct spi_shutdown {
  struct object object;
  const struct spi *spi;
  volatile bool due;
  uint8_t size;
  uint8_t bytes[];
};

// The device if it has its bus, or null after a shutdown. Foreground.
struct spi *spi_get(uint32_t oid);
// Sends bytes and puts the received ones in their place. Foreground.
void spi_exchange(const struct spi *spi, uint8_t *bytes, uint8_t size);
// Sends the bytes for a shutdown. Foreground.
void spi_send_last(void);
