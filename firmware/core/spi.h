// SPI over any pins, by software, for motor drivers and sensors that are read now and then.
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
  uint16_t pulse_ticks;  // minimum duration of half a bit
  bool has_select, select_level, has_bus;
  bool clock_rest;    // level of the clock between transfers (CPOL)
  bool second_phase;  // data are sampled at the second edge of the clock (CPHA)
};

// Bytes that are sent at a shutdown.
struct spi_shutdown {
  struct object object;
  const struct spi *spi;
  volatile bool due;
  uint8_t size;
  uint8_t bytes[];
};

// Returns the device if its bus is set up; otherwise shuts down and returns null. Foreground.
struct spi *spi_get(uint32_t oid);
// Sends bytes, and replaces them by the received bytes. Foreground.
void spi_exchange(const struct spi *spi, uint8_t *bytes, uint8_t size);
// Sends the bytes for a shutdown. Foreground.
void spi_send_last(void);
