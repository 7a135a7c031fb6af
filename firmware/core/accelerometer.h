// Accelerometers: an ADXL345 on an SPI bus, or a LIS2DW on SPI or I2C, whose FIFO is read at
// regular times. The host sets up and starts the chip; samples go to it in blocks.
#pragma once
#include <stdbool.h>
#include <stdint.h>

#include "i2c.h"
#include "object.h"
#include "scheduler.h"
#include "spi.h"

#define BLOCK_BYTES 51  // maximum size of a report

struct accelerometer {
  struct object object;
  struct timer timer;
  const struct spi *spi;  // or null
  struct i2c *i2c;
  uint32_t rest_ticks;
  uint16_t sequence, overflows;
  bool lis2dw;
  volatile bool due;
  uint8_t taken;  // samples since the last read was due
  uint8_t size;   // bytes used in `block`
  uint8_t block[BLOCK_BYTES];
};
