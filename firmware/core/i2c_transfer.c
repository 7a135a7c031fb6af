// I2C transfers that the host requests.
#include <string.h>

#include "command.h"
#include "frame.h"
#include "i2c.h"
#include "shutdown.h"

DECL_SHUTDOWN_REASON(I2C_TOO_LONG, "I2C data too large");
DECL_ENUMERATION("i2c_bus_status", "SUCCESS", 0);
DECL_ENUMERATION("i2c_bus_status", "NACK", 1);
DECL_ENUMERATION("i2c_bus_status", "BUS_TIMEOUT", 2);
DECL_ENUMERATION("i2c_bus_status", "START_NACK", 3);
DECL_ENUMERATION("i2c_bus_status", "START_READ_NACK", 4);
DECL_REPORT("i2c_response oid=%c i2c_bus_status=%c response=%*s");

DECL_COMMAND(command_i2c_transfer, "i2c_transfer oid=%c write=%*s read_len=%u", 0);
void command_i2c_transfer(const uint32_t *args) {
  struct i2c *i2c = i2c_get(args[0]);
  if (i2c == NULL) return;
  uint8_t in[FRAME_MAX];
  if (args[2] > sizeof in) {
    shut_down(SHUTDOWN_I2C_TOO_LONG);
    return;
  }
  memset(in, 0, sizeof in);
  uint8_t status = i2c_exchange(i2c, command_bytes(), (uint8_t)args[1], in, (uint8_t)args[2]);
  report_bytes(REPORT_I2C_RESPONSE, (uint32_t[]){args[0], status}, 2, in, (uint8_t)args[2]);
}
