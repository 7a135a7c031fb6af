// I2C over any two pins, by software, as the only master. A line is pulled low or released; pull-up
// resistors of the bus and of the pins pull it high.
#pragma once
#include <stdbool.h>
#include <stdint.h>

#include "hal.h"
#include "object.h"

// Result of a transfer: success; a byte was not acknowledged; a device held the clock low for too
// long; the address was not acknowledged, for writing or for reading.
enum i2c_status {
  I2C_SUCCESS,
  I2C_NACK,
  I2C_BUS_TIMEOUT,
  I2C_START_NACK,
  I2C_START_READ_NACK,
};

struct i2c_line {
  struct hal_output output;
  struct hal_input input;
  uint16_t pin;
  bool released;
};

struct i2c {
  struct object object;
  struct i2c_line clock, data;
  uint16_t pulse_ticks;  // minimum duration of half a bit
  uint8_t address;       // in the upper seven bits
  bool has_bus;
  uint16_t patience;  // remaining pulses; at 0 the clock stays low
};

// Returns the device if its bus is set up; otherwise shuts down and returns null. Foreground.
struct i2c *i2c_get(uint32_t oid);
// Writes bytes, then reads bytes into `in`, which is incomplete after an error. Foreground.
enum i2c_status i2c_exchange(struct i2c *i2c, const uint8_t *out, uint8_t out_size, uint8_t *in,
                             uint8_t in_size);
