#include "accelerometer.h"

#include <stddef.h>
#include <string.h>

#include "command.h"
#include "shutdown.h"

DECL_SHUTDOWN_REASON(ACCELEROMETER_TYPE, "Invalid accelerometer type");
DECL_ENUMERATION("bus_oid_type", "spi", 0);
DECL_ENUMERATION("bus_oid_type", "i2c", 1);
DECL_ENUMERATION("lis_chip_type", "LIS2DW", 0);
DECL_REPORT("sensor_bulk_data oid=%c sequence=%hu data=%*s");
DECL_REPORT(
    "sensor_bulk_status oid=%c clock=%u query_ticks=%u next_sequence=%hu buffered=%u"
    " possible_overflows=%hu");

#define READ 0x80
#define SEVERAL 0x40  // ADXL345: the register address increments with each byte
#define ADXL_DATA 0x32
#define ADXL_FIFO 0x39
#define ADXL_FIFO_SETTING 0x90  // set by the host: the FIFO keeps the newest samples
#define ADXL_BYTES 5
#define LIS_DATA 0x28
#define LIS_FIFO 0x2f
#define LIS_OVERFLOW 0x40
#define LIS_BYTES 6
#define FIFO_DEEP 32
#define DISTURBED 0xff  // returned in place of a number of samples

enum { BUS_SPI, BUS_I2C };

static bool run(struct timer *timer) {
  struct accelerometer *it =
      (struct accelerometer *)((char *)timer - offsetof(struct accelerometer, timer));
  it->due = true;
  it->taken = 0;
  task_wake();
  return false;
}

static const struct object_kind kind = {OBJECT_ACCELEROMETER, NULL};

static uint8_t sample_bytes(const struct accelerometer *it) {
  return it->lis2dw ? LIS_BYTES : ADXL_BYTES;
}

static uint8_t spi_register(const struct accelerometer *it, uint8_t address) {
  uint8_t bytes[2] = {(uint8_t)(address | READ), 0};
  spi_exchange(it->spi, bytes, sizeof bytes);
  return bytes[1];
}

// Extends the sign of a 13-bit number.
static bool extended(uint8_t high) { return (high & 0xf0) == 0 || (high & 0xf0) == 0xf0; }

// Each function appends samples to the block. Returns true if the FIFO may hold more.
static bool take_adxl345(struct accelerometer *it, uint8_t *to) {
  uint8_t in[9] = {ADXL_DATA | READ | SEVERAL};
  spi_exchange(it->spi, in, sizeof in);
  it->size = (uint8_t)(it->size + ADXL_BYTES);
  uint8_t left = in[8] & 0x7f;
  if (!extended(in[2]) || !extended(in[4]) || !extended(in[6]) || in[7] != ADXL_FIFO_SETTING ||
      left > FIFO_DEEP) {
    memset(to, 0xff, ADXL_BYTES);  // reads of a disturbed transfer
    return false;
  }
  to[0] = in[1];
  to[1] = in[3];
  to[2] = in[5];
  to[3] = (uint8_t)((in[2] & 0x1f) | in[6] << 5);
  to[4] = (uint8_t)((in[4] & 0x1f) | (in[6] << 2 & 0x60));
  if (left >= FIFO_DEEP - 1) ++it->overflows;
  return left > 1;
}

// Returns the number of samples in the FIFO, or DISTURBED if the register exceeds the size of the
// FIFO.
static uint8_t lis_waiting(struct accelerometer *it, uint8_t state) {
  uint8_t samples = state & 0x3f;
  if (samples > FIFO_DEEP) return DISTURBED;
  if (state & LIS_OVERFLOW) ++it->overflows;
  return samples;
}

static bool take_lis2dw_spi(struct accelerometer *it, uint8_t *to) {
  uint8_t in[1 + LIS_BYTES] = {LIS_DATA | READ};
  spi_exchange(it->spi, in, sizeof in);
  it->size = (uint8_t)(it->size + LIS_BYTES);
  memcpy(to, in + 1, LIS_BYTES);
  return lis_waiting(it, spi_register(it, LIS_FIFO)) != 0;
}

static uint8_t i2c_waiting(struct accelerometer *it) {
  uint8_t address = LIS_FIFO, state;
  enum i2c_status status = i2c_exchange(it->i2c, &address, 1, &state, 1);
  return status == I2C_SUCCESS ? lis_waiting(it, state) : DISTURBED;
}

// The bus is slow, so one transfer takes as many samples as fit. After a transfer that the chip has
// not acknowledged, samples wait until the next read, or until the chip reports an overflow of its
// FIFO.
static bool take_lis2dw_i2c(struct accelerometer *it, uint8_t *to) {
  uint8_t waiting = i2c_waiting(it), address = LIS_DATA;
  if (waiting == DISTURBED || waiting == 0) return false;
  uint8_t room = (uint8_t)((BLOCK_BYTES - it->size) / LIS_BYTES);
  uint8_t bytes = (uint8_t)((waiting < room ? waiting : room) * LIS_BYTES);
  if (i2c_exchange(it->i2c, &address, 1, to, bytes) != I2C_SUCCESS) return false;
  it->size = (uint8_t)(it->size + bytes);
  return waiting > room;
}

static bool take(struct accelerometer *it) {
  uint8_t *to = it->block + it->size;
  if (it->spi == NULL) return take_lis2dw_i2c(it, to);
  return it->lis2dw ? take_lis2dw_spi(it, to) : take_adxl345(it, to);
}

// Takes a few samples of each accelerometer that is due, so that other tasks run in between.
DECL_TASK(accelerometer_task, BUSES);
void accelerometer_task(void) {
  struct accelerometer *it;
  for (int16_t oid = -1; (it = object_next(&oid, OBJECT_ACCELEROMETER)) != NULL;) {
    if (!it->due) continue;
    bool more = take(it);
    if (it->size + sample_bytes(it) > BLOCK_BYTES) {
      uint32_t values[] = {(uint8_t)oid, it->sequence++};
      report_bytes(REPORT_SENSOR_BULK_DATA, values, 2, it->block, it->size);
      it->size = 0;
    }
    // More samples than the FIFO holds: the answers do not come from the chip.
    if (more && ++it->taken < FIFO_DEEP) {
      task_wake();
      continue;
    }
    it->due = false;
    hal_irq_t irq = hal_irq_save();
    it->timer.wake = hal_clock() + it->rest_ticks;
    timer_add(&it->timer);
    hal_irq_restore(irq);
  }
}

// Some hosts assign the bus later, but before the first transfer.
static bool check_bus(const struct accelerometer *it) {
  if (it->spi != NULL ? it->spi->has_bus : it->i2c->has_bus) return true;
  shut_down(it->spi != NULL ? SHUTDOWN_SPI_NO_BUS : SHUTDOWN_I2C_NO_BUS);
  return false;
}

static void configure(const uint32_t *args, bool lis2dw, bool on_i2c) {
  void *device = object_get(args[1], on_i2c ? OBJECT_I2C : OBJECT_SPI);
  if (device == NULL) return;
  struct accelerometer *it = object_add(args[0], &kind, sizeof *it);
  if (it == NULL) return;
  it->timer.run = run;
  if (on_i2c)
    it->i2c = device;
  else
    it->spi = device;
  it->lis2dw = lis2dw;
}

static void query(const uint32_t *args) {
  struct accelerometer *it = object_get(args[0], OBJECT_ACCELEROMETER);
  if (it == NULL) return;
  timer_remove(&it->timer);
  it->due = false;
  it->size = 0;
  it->sequence = it->overflows = 0;
  it->rest_ticks = args[1];
  if (args[1] == 0 || !check_bus(it)) return;
  if (args[1] < HAL_SHORTEST_PERIOD) {
    shut_down(SHUTDOWN_PERIOD_TOO_SHORT);
    return;
  }
  hal_irq_t irq = hal_irq_save();
  it->timer.wake = hal_clock() + it->rest_ticks;
  timer_add(&it->timer);
  hal_irq_restore(irq);
}

static uint8_t waiting(struct accelerometer *it) {
  if (it->spi == NULL) return i2c_waiting(it);
  if (it->lis2dw) return lis_waiting(it, spi_register(it, LIS_FIFO));
  return spi_register(it, ADXL_FIFO) & 0x7f;
}

static void tell_state(const uint32_t *args) {
  struct accelerometer *it = object_get(args[0], OBJECT_ACCELEROMETER);
  if (it == NULL || !check_bus(it)) return;
  uint32_t clock = hal_clock();
  uint8_t samples = waiting(it);
  if (samples > FIFO_DEEP) return;  // the transfer was disturbed: the host asks again
  uint32_t ticks = hal_clock() - clock, buffered = it->size + (uint32_t)samples * sample_bytes(it);
  uint32_t values[] = {args[0], clock, ticks, it->sequence, buffered, it->overflows};
  report(REPORT_SENSOR_BULK_STATUS, values, 6);
}

DECL_COMMAND(command_config_adxl345, "config_adxl345 oid=%c spi_oid=%c", 0);
void command_config_adxl345(const uint32_t *args) { configure(args, false, false); }

DECL_COMMAND(command_query_adxl345, "query_adxl345 oid=%c rest_ticks=%u", 0);
void command_query_adxl345(const uint32_t *args) { query(args); }

DECL_COMMAND(command_query_adxl345_status, "query_adxl345_status oid=%c", 0);
void command_query_adxl345_status(const uint32_t *args) { tell_state(args); }

DECL_COMMAND(command_config_lis2dw,
             "config_lis2dw oid=%c bus_oid=%c bus_oid_type=%c lis_chip_type=%c", 0);
void command_config_lis2dw(const uint32_t *args) {
  if (args[2] > BUS_I2C || args[3] != 0) {
    shut_down(SHUTDOWN_ACCELEROMETER_TYPE);
    return;
  }
  configure(args, true, args[2] == BUS_I2C);
}

DECL_COMMAND(command_query_lis2dw, "query_lis2dw oid=%c rest_ticks=%u", 0);
void command_query_lis2dw(const uint32_t *args) { query(args); }

DECL_COMMAND(command_query_lis2dw_status, "query_lis2dw_status oid=%c", 0);
void command_query_lis2dw_status(const uint32_t *args) { tell_state(args); }
