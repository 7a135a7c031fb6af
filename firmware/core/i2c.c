#include "i2c.h"

#include "command.h"
#include "shutdown.h"
#include "wait.h"

DECL_SHUTDOWN_REASON(I2C_PINS, "Pins cannot make an I2C bus");
DECL_SHUTDOWN_REASON(I2C_NO_BUS, "I2C device without a bus");
DECL_SHUTDOWN_REASON(I2C_TOO_SLOW, "I2C clock too slow for this board");

#define STRETCH_PULSES 1000  // maximum time in a transfer that devices may hold the clock low

static const struct object_kind kind = {OBJECT_I2C, NULL};

// Changing the direction of a pin takes about a microsecond, so it is done only when the level
// changes.
static void set(struct i2c_line *line, bool high) {
  if (line->released == high) return;
  line->released = high;
  if (high)
    hal_input_setup(&line->input, line->pin, true);
  else
    hal_output_setup(&line->output, line->pin, false);
}
static void pull(struct i2c_line *line) { set(line, false); }
static void let_go(struct i2c_line *line) { set(line, true); }

// Releases the clock, and waits while a device holds it low.
static void rise(struct i2c *i2c) {
  let_go(&i2c->clock);
  HAL_WAIT(i2c->pulse_ticks);
  for (; i2c->patience > 0 && !hal_input_read(&i2c->clock.input); --i2c->patience)
    HAL_WAIT(i2c->pulse_ticks);
}

// Sends or receives one bit. The line is sampled while the clock is high; a sent bit reads back
// unless a device pulls the line low.
static bool bit(struct i2c *i2c, bool value) {
  set(&i2c->data, value);
  HAL_WAIT(i2c->pulse_ticks);
  rise(i2c);
  bool seen = hal_input_read(&i2c->data.input);
  pull(&i2c->clock);
  return seen;
}

// Sends a start condition, also in the middle of a transfer.
static void start(struct i2c *i2c) {
  let_go(&i2c->data);
  HAL_WAIT(i2c->pulse_ticks);
  rise(i2c);
  pull(&i2c->data);
  HAL_WAIT(i2c->pulse_ticks);
  pull(&i2c->clock);
}

static void stop(struct i2c *i2c) {
  pull(&i2c->data);
  HAL_WAIT(i2c->pulse_ticks);
  rise(i2c);
  let_go(&i2c->data);
  HAL_WAIT(i2c->pulse_ticks);
}

// Sends a byte; returns true if the device acknowledges it.
static bool send(struct i2c *i2c, uint8_t byte) {
  for (uint8_t i = 0; i < 8; ++i) bit(i2c, byte >> (7 - i) & 1);
  return !bit(i2c, true);
}

static uint8_t receive(struct i2c *i2c, bool more) {
  uint8_t byte = 0;
  for (uint8_t i = 0; i < 8; ++i) byte = (uint8_t)(byte << 1 | bit(i2c, true));
  bit(i2c, !more);
  return byte;
}

static enum i2c_status exchange(struct i2c *i2c, const uint8_t *out, uint8_t out_size, uint8_t *in,
                                uint8_t in_size) {
  if (out_size > 0 || in_size == 0) {
    start(i2c);
    if (!send(i2c, i2c->address)) return I2C_START_NACK;
    for (; out_size > 0; --out_size)
      if (!send(i2c, *out++)) return I2C_NACK;
  }
  if (in_size == 0) return I2C_SUCCESS;
  start(i2c);
  if (!send(i2c, i2c->address | 1)) return I2C_START_READ_NACK;
  while (in_size-- > 0) *in++ = receive(i2c, in_size > 0);
  return I2C_SUCCESS;
}

enum i2c_status i2c_exchange(struct i2c *i2c, const uint8_t *out, uint8_t out_size, uint8_t *in,
                             uint8_t in_size) {
  i2c->patience = STRETCH_PULSES;
  enum i2c_status status = exchange(i2c, out, out_size, in, in_size);
  stop(i2c);
  return i2c->patience == 0 ? I2C_BUS_TIMEOUT : status;
}

struct i2c *i2c_get(uint32_t oid) {
  struct i2c *i2c = object_get(oid, OBJECT_I2C);
  if (i2c == NULL || i2c->has_bus) return i2c;
  shut_down(SHUTDOWN_I2C_NO_BUS);
  return NULL;
}

DECL_COMMAND(command_config_i2c, "config_i2c oid=%c", 0);
void command_config_i2c(const uint32_t *args) { object_add(args[0], &kind, sizeof(struct i2c)); }

static bool line_setup(struct i2c_line *line, uint32_t pin) {
  line->pin = (uint16_t)pin;
  line->released = true;
  return pin <= 0xffff && hal_output_setup(&line->output, line->pin, true) &&
         hal_input_setup(&line->input, line->pin, true);
}

DECL_COMMAND(command_i2c_set_sw_bus,
             "i2c_set_sw_bus oid=%c scl_pin=%u sda_pin=%u pulse_ticks=%u address=%u", 0);
void command_i2c_set_sw_bus(const uint32_t *args) {
  struct i2c *i2c = object_get(args[0], OBJECT_I2C);
  if (i2c == NULL) return;
  if (args[3] > LONGEST_PULSE) {
    shut_down(SHUTDOWN_I2C_TOO_SLOW);
    return;
  }
  i2c->pulse_ticks = (uint16_t)args[3];
  i2c->address = (uint8_t)(args[4] << 1);
  i2c->has_bus = line_setup(&i2c->clock, args[1]) && line_setup(&i2c->data, args[2]);
  if (!i2c->has_bus) shut_down(SHUTDOWN_I2C_PINS);
}
