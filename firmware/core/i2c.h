// I2C over any two pins, by software, as the only master. A line is pulled low or released; the
// pull-ups are those of the bus, and the pins'.
#pragma once
#include <stdbool.h>
#include <stdint.h>

#include "hal.h"
#include "object.h"

// How a transfer ended: the device has taken all; it has refused a byte; it, or another device,
// held the clock low; it has not answered to its address, to write or to read.
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
  uint16_t pulse_ticks;  // half a bit, at least
  uint8_t address;       // in the upper seven bits
  bool has_bus;
  uint16_t patience;  // pulses; none left: the clock stays low
};

// The device if it has its bus, or null after a shutdown. Foreground.
struct i2c *i2c_get(uint32_t oid);
// Writes bytes, then reads some into `in`, which is incomplete after an error. Foreground.
enum i2c_status i2c_exchange(struct i2c *i2c, const uint8_t *out, uint8_t out_size, uint8_t *in,
                             uint8_t in_size);
