// Transfers over I2C as older hosts ask for them: without a status, so that the board shuts down at
// an error. A build for those takes this file in place of its namesake in core/.
#include <string.h>

#include "command.h"
#include "frame.h"
#include "i2c.h"
#include "shutdown.h"

DECL_SHUTDOWN_REASON(I2C_TOO_LONG, "I2C data too large");
DECL_SHUTDOWN_REASON(I2C_NACK, "I2C NACK");
DECL_SHUTDOWN_REASON(I2C_TIMEOUT, "I2C Timeout");
DECL_REPORT("i2c_read_response oid=%c response=%*s");

static bool transfer(const uint32_t *args, uint8_t *in, uint8_t in_size) {
  struct i2c *i2c = i2c_get(args[0]);
  if (i2c == NULL) return false;
  enum i2c_status status = i2c_exchange(i2c, command_bytes(), (uint8_t)args[1], in, in_size);
  if (status == I2C_SUCCESS) return true;
  shut_down(status == I2C_BUS_TIMEOUT ? SHUTDOWN_I2C_TIMEOUT : SHUTDOWN_I2C_NACK);
  return false;
}

DECL_COMMAND(command_i2c_write, "i2c_write oid=%c data=%*s", 0);
void command_i2c_write(const uint32_t *args) { transfer(args, NULL, 0); }

DECL_COMMAND(command_i2c_read, "i2c_read oid=%c reg=%*s read_len=%u", 0);
void command_i2c_read(const uint32_t *args) {
  uint8_t in[FRAME_MAX];
  if (args[2] > sizeof in) {
    shut_down(SHUTDOWN_I2C_TOO_LONG);
    return;
  }
  memset(in, 0, sizeof in);
  if (transfer(args, in, (uint8_t)args[2]))
    report_bytes(REPORT_I2C_READ_RESPONSE, args, 1, in, (uint8_t)args[2]);
}
