#include "spi.h"

#include <string.h>

#include "command.h"
#include "shutdown.h"
#include "wait.h"

DECL_SHUTDOWN_REASON(SPI_PINS, "Pins cannot make an SPI bus");
DECL_SHUTDOWN_REASON(SPI_NO_BUS, "SPI device without a bus");
DECL_SHUTDOWN_REASON(SPI_TOO_SLOW, "SPI clock too slow for this board");
DECL_REPORT("spi_transfer_response oid=%c response=%*s");

static uint8_t exchange(const struct spi *spi, uint8_t byte) {
  for (uint8_t bit = 0; bit < 8; ++bit) {
    if (spi->second_phase) hal_output_write(&spi->clock, !spi->clock_rest);
    hal_output_write(&spi->to_device, byte & 0x80);
    HAL_WAIT(spi->pulse_ticks);
    hal_output_write(&spi->clock, spi->second_phase == spi->clock_rest);
    byte = (uint8_t)(byte << 1 | hal_input_read(&spi->from_device));
    HAL_WAIT(spi->pulse_ticks);
    if (!spi->second_phase) hal_output_write(&spi->clock, spi->clock_rest);
  }
  return byte;
}

void spi_exchange(const struct spi *spi, uint8_t *bytes, uint8_t size) {
  hal_output_write(&spi->clock, spi->clock_rest);  // another device may need another mode
  if (spi->has_select) hal_output_write(&spi->select, spi->select_level);
  for (; size > 0; --size, ++bytes) *bytes = exchange(spi, *bytes);
  if (spi->has_select) hal_output_write(&spi->select, !spi->select_level);
}

static const struct object_kind kind = {OBJECT_SPI, NULL};

// A shutdown may interrupt a transfer: that transfer ends first.
static void send_soon(void *object) { ((struct spi_shutdown *)object)->due = true; }
static const struct object_kind shutdown_kind = {OBJECT_SPI_SHUTDOWN, send_soon};

DECL_TASK(spi_send_last, DEVICES);
DECL_ON_CLEAR_SHUTDOWN(spi_send_last);
void spi_send_last(void) {
  struct spi_shutdown *last;
  for (int16_t oid = -1; (last = object_next(&oid, OBJECT_SPI_SHUTDOWN)) != NULL;) {
    if (!last->due) continue;
    last->due = false;
    uint8_t bytes[FRAME_MAX];
    memcpy(bytes, last->bytes, last->size);
    spi_exchange(last->spi, bytes, last->size);
  }
}

struct spi *spi_get(uint32_t oid) {
  struct spi *spi = object_get(oid, OBJECT_SPI);
  if (spi == NULL || spi->has_bus) return spi;
  shut_down(SHUTDOWN_SPI_NO_BUS);
  return NULL;
}

DECL_COMMAND(command_config_spi, "config_spi oid=%c pin=%u cs_active_high=%c", 0);
void command_config_spi(const uint32_t *args) {
  struct spi *spi = object_add(args[0], &kind, sizeof *spi);
  if (spi == NULL) return;
  spi->has_select = true;
  spi->select_level = args[2] != 0;
  if (args[1] > 0xffff || !hal_output_setup(&spi->select, (uint16_t)args[1], !spi->select_level))
    shut_down(SHUTDOWN_SPI_PINS);
}

DECL_COMMAND(command_config_spi_without_cs, "config_spi_without_cs oid=%c", 0);
void command_config_spi_without_cs(const uint32_t *args) {
  object_add(args[0], &kind, sizeof(struct spi));
}

DECL_COMMAND(command_spi_set_sw_bus,
             "spi_set_sw_bus oid=%c miso_pin=%u mosi_pin=%u sclk_pin=%u mode=%u pulse_ticks=%u", 0);
void command_spi_set_sw_bus(const uint32_t *args) {
  struct spi *spi = object_get(args[0], OBJECT_SPI);
  if (spi == NULL) return;
  if (args[5] > LONGEST_PULSE) {
    shut_down(SHUTDOWN_SPI_TOO_SLOW);
    return;
  }
  spi->clock_rest = args[4] >> 1 & 1;
  spi->second_phase = args[4] & 1;
  spi->pulse_ticks = (uint16_t)args[5];
  spi->has_bus = args[1] <= 0xffff && args[2] <= 0xffff && args[3] <= 0xffff && args[4] <= 3 &&
                 hal_input_setup(&spi->from_device, (uint16_t)args[1], true) &&
                 hal_output_setup(&spi->to_device, (uint16_t)args[2], false) &&
                 hal_output_setup(&spi->clock, (uint16_t)args[3], spi->clock_rest);
  if (!spi->has_bus) shut_down(SHUTDOWN_SPI_PINS);
}

DECL_COMMAND(command_config_spi_shutdown, "config_spi_shutdown oid=%c spi_oid=%c shutdown_msg=%*s",
             0);
void command_config_spi_shutdown(const uint32_t *args) {
  const struct spi *spi = spi_get(args[1]);
  if (spi == NULL) return;
  struct spi_shutdown *last = object_add(args[0], &shutdown_kind, sizeof *last + args[2]);
  if (last == NULL) return;
  memcpy(last->bytes, command_bytes(), args[2]);
  last->size = (uint8_t)args[2];
  last->spi = spi;
  if (is_shut_down()) last->due = true;  // a shutdown may have come just now
}

DECL_COMMAND(command_spi_transfer, "spi_transfer oid=%c data=%*s", 0);
void command_spi_transfer(const uint32_t *args) {
  const struct spi *spi = spi_get(args[0]);
  if (spi == NULL) return;
  uint8_t bytes[FRAME_MAX];
  memcpy(bytes, command_bytes(), args[1]);
  spi_exchange(spi, bytes, (uint8_t)args[1]);
  report_bytes(REPORT_SPI_TRANSFER_RESPONSE, args, 1, bytes, (uint8_t)args[1]);
}

DECL_COMMAND(command_spi_send, "spi_send oid=%c data=%*s", 0);
void command_spi_send(const uint32_t *args) {
  const struct spi *spi = spi_get(args[0]);
  if (spi == NULL) return;
  uint8_t bytes[FRAME_MAX];
  memcpy(bytes, command_bytes(), args[1]);
  spi_exchange(spi, bytes, (uint8_t)args[1]);
}
