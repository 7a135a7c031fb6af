#include "thermocouple.h"

#include <stddef.h>

#include "command.h"
#include "shutdown.h"
#include "survive_state.h"

DECL_SHUTDOWN_REASON(THERMOCOUPLE_TYPE, "Invalid thermocouple chip type");
DECL_SHUTDOWN_REASON(THERMOCOUPLE_RANGE, "Thermocouple ADC out of range");
DECL_SHUTDOWN_REASON(THERMOCOUPLE_FAULT, "Thermocouple reader fault");
DECL_ENUMERATION("thermocouple_type", "MAX31855", 0);
DECL_ENUMERATION("thermocouple_type", "MAX31856", 1);
DECL_ENUMERATION("thermocouple_type", "MAX31865", 2);
DECL_ENUMERATION("thermocouple_type", "MAX6675", 3);
DECL_REPORT("thermocouple_result oid=%c next_clock=%u value=%u fault=%c");

#define NO_REGISTER 0xff

// Layout of a converter: the register of its value (if it has registers) and the number of bytes;
// the register of its faults, or the bit of the value that means any fault.
static const struct converter {
  uint8_t word_register, word_bytes, fault_register;
  uint32_t fault_bit;
} HAL_CONST converters[] = {
    {NO_REGISTER, 4, NO_REGISTER, 0x10000},
    {0x0c, 3, 0x0f, 0},
    {0x01, 2, 0x07, 0},
    {NO_REGISTER, 2, NO_REGISTER, 0x04},
};

static bool run(struct timer *timer) {
  struct thermocouple *it =
      (struct thermocouple *)((char *)timer - offsetof(struct thermocouple, timer));
  it->due = true;
  timer->wake += it->rest_ticks;
  task_wake();
  return true;
}

static const struct object_kind kind = {OBJECT_THERMOCOUPLE, NULL};

// Reads a register, or the value of a converter without registers; the first byte is the highest.
static uint32_t ask(const struct spi *spi, uint8_t address, uint8_t size) {
  uint8_t bytes[5] = {address}, skip = address != NO_REGISTER;
  if (!skip) bytes[0] = 0;
  spi_exchange(spi, bytes, (uint8_t)(size + skip));
  uint32_t word = 0;
  for (uint8_t i = 0; i < size; ++i) word = word << 8 | bytes[i + skip];
  return word;
}

static void watch(struct thermocouple *it, uint32_t word, bool fault) {
  if (it->minimum == 0 && it->maximum == UINT32_MAX) return;
  bool outside = word < it->minimum || word > it->maximum;
  if (!outside && !fault)
    it->faults = 0;
  else if (++it->faults >= it->max_faults)
    shut_down(outside ? SHUTDOWN_THERMOCOUPLE_RANGE : SHUTDOWN_THERMOCOUPLE_FAULT);
}

DECL_WATCH(thermocouple_watches);
bool thermocouple_watches(void) {
  const struct thermocouple *it;
  for (int16_t oid = -1; (it = object_next(&oid, OBJECT_THERMOCOUPLE)) != NULL;)
    if (it->rest_ticks != 0 && (it->minimum != 0 || it->maximum != UINT32_MAX)) return true;
  return false;
}

// Reads the converters that are due, and reports.
DECL_TASK(thermocouple_task, BUSES);
void thermocouple_task(void) {
  struct thermocouple *it;
  for (int16_t oid = -1; (it = object_next(&oid, OBJECT_THERMOCOUPLE)) != NULL;) {
    hal_irq_t irq = hal_irq_save();
    bool due = it->due;
    uint32_t next = it->timer.wake;
    it->due = false;
    hal_irq_restore(irq);
    if (!due) continue;
    const struct converter *converter = &converters[it->type];
    uint8_t fault_register = hal_const8(&converter->fault_register);
    uint32_t word =
        ask(it->spi, hal_const8(&converter->word_register), hal_const8(&converter->word_bytes));
    uint8_t fault = fault_register == NO_REGISTER ? 0 : (uint8_t)ask(it->spi, fault_register, 1);
    report(REPORT_THERMOCOUPLE_RESULT, (uint32_t[]){(uint8_t)oid, next, word, fault}, 4);
    watch(it, word, fault != 0 || (word & hal_const32(&converter->fault_bit)) != 0);
  }
}

DECL_COMMAND(command_config_thermocouple,
             "config_thermocouple oid=%c spi_oid=%c thermocouple_type=%c", 0);
void command_config_thermocouple(const uint32_t *args) {
  if (args[2] >= sizeof converters / sizeof *converters) {
    shut_down(SHUTDOWN_THERMOCOUPLE_TYPE);
    return;
  }
  const struct spi *spi = spi_get(args[1]);
  if (spi == NULL) return;
  struct thermocouple *it = object_add(args[0], &kind, sizeof *it);
  if (it == NULL) return;
  it->timer.run = run;
  it->timer.lasting = true;
  it->spi = spi;
  it->type = (uint8_t)args[2];
}

DECL_COMMAND(command_query_thermocouple,
             "query_thermocouple oid=%c clock=%u rest_ticks=%u min_value=%u max_value=%u"
             " max_invalid_count=%c",
             0);
void command_query_thermocouple(const uint32_t *args) {
  struct thermocouple *it = object_get(args[0], OBJECT_THERMOCOUPLE);
  if (it == NULL) return;
  timer_remove(&it->timer);
  it->due = false;
  it->rest_ticks = 0;
  if (args[2] == 0) return;
  if (args[2] < HAL_SHORTEST_PERIOD) {
    shut_down(SHUTDOWN_PERIOD_TOO_SHORT);
    return;
  }
  it->rest_ticks = args[2];
  it->minimum = args[3];
  it->maximum = args[4];
  it->max_faults = (uint8_t)args[5];  // 0 acts as 1, as in Klipper's firmware
  it->faults = 0;
  hal_irq_t irq = hal_irq_save();
  it->timer.wake = survive_in_time(args[1]);
  timer_add(&it->timer);
  hal_irq_restore(irq);
}
