#include "analog_in.h"

#include <stddef.h>

#include "command.h"
#include "shutdown.h"
#include "survive_state.h"

DECL_SHUTDOWN_REASON(ADC_RANGE, "ADC out of range");
DECL_SHUTDOWN_REASON(ADC_SILENT, "ADC gives no value");
DECL_SHUTDOWN_REASON(ADC_PIN, "Not a valid ADC pin");

// Maximum duration of a conversion, including all conversions before it.
#define SILENT (HAL_CLOCK_HZ / 10)

// Stores a complete sum.
static void take(struct analog_in *in) {
  if (in->ready) in->size = in->ready = 0;  // the foreground has not sent the last one yet
  in->values[in->size++] = (uint8_t)in->sum;
  in->values[in->size++] = (uint8_t)(in->sum >> 8);
  if (in->size >= in->query.report_size) {
    in->ready = in->size;
    task_wake();
  }
  if (in->sum >= in->query.minimum && in->sum <= in->query.maximum) {
    in->outside = 0;
  } else if (in->query.range_checks != 0 && ++in->outside >= in->query.range_checks) {
    in->outside = 0;
    shut_down(SHUTDOWN_ADC_RANGE);
  }
}

static bool run(struct timer *timer) {
  struct analog_in *in = (struct analog_in *)((char *)timer - offsetof(struct analog_in, timer));
  uint16_t value;
  if (!hal_analog_read(&in->analog, &value)) {
    if (hal_clock() - in->due > SILENT) {
      shut_down(SHUTDOWN_ADC_SILENT);  // otherwise the temperature would not be monitored
      return false;
    }
    timer->wake = hal_clock() + HAL_ANALOG_WAIT;
    return true;
  }
  in->sum += value;
  in->due += in->query.sample_ticks;
  if (++in->samples == in->query.sample_count) {
    in->begin += in->query.rest_ticks;
    take(in);
    in->due = in->begin;
    in->samples = 0;
    in->sum = 0;
  }
  timer->wake = in->due;
  return true;
}

static const struct object_kind kind = {OBJECT_ANALOG_IN, NULL};

DECL_WATCH(analog_in_watches);
bool analog_in_watches(void) {
  const struct analog_in *in;
  for (int16_t oid = -1; (in = object_next(&oid, OBJECT_ANALOG_IN)) != NULL;)
    if (in->watching) return true;
  return false;
}

DECL_TASK(analog_in_task, INPUTS);
void analog_in_task(void) {
  struct analog_in *in;
  for (int16_t oid = -1; (in = object_next(&oid, OBJECT_ANALOG_IN)) != NULL;) {
    uint8_t values[sizeof in->values];
    hal_irq_t irq = hal_irq_save();
    uint8_t size = in->ready;
    uint32_t next = in->begin;
    for (uint8_t i = 0; i < size; ++i) values[i] = in->values[i];
    if (size > 0) in->size = in->ready = 0;
    hal_irq_restore(irq);
    if (size > 0) analog_in_report((uint8_t)oid, next, values, size);
  }
}

DECL_COMMAND(command_config_analog_in, "config_analog_in oid=%c pin=%u", 0);
void command_config_analog_in(const uint32_t *args) {
  struct analog_in *in = object_add(args[0], &kind, sizeof *in);
  if (in == NULL) return;
  in->timer.run = run;
  in->timer.lasting = true;
  if (args[1] > 0xffff || !hal_analog_setup(&in->analog, (uint16_t)args[1]))
    shut_down(SHUTDOWN_ADC_PIN);
}

void analog_in_query(const uint32_t *args, uint8_t report_size, const uint32_t *range) {
  struct analog_in *in = object_get(args[0], OBJECT_ANALOG_IN);
  if (in == NULL) return;
  timer_remove(&in->timer);
  hal_analog_cancel(&in->analog);
  in->watching = false;
  if (args[3] == 0) return;
  if (args[4] < HAL_SHORTEST_PERIOD) {
    shut_down(SHUTDOWN_PERIOD_TOO_SHORT);
    return;
  }
  in->query.sample_ticks = args[2];
  in->query.sample_count = (uint8_t)args[3];
  in->query.rest_ticks = args[4];
  in->query.minimum = (uint16_t)range[0];
  in->query.maximum = (uint16_t)range[1];
  in->query.range_checks = (uint8_t)range[2];
  in->query.report_size = report_size > sizeof in->values ? sizeof in->values : report_size;
  in->sum = 0;
  in->samples = in->outside = in->size = in->ready = 0;
  in->watching = range[2] != 0;
  hal_irq_t irq = hal_irq_save();
  in->timer.wake = in->begin = in->due = survive_in_time(args[1]);
  timer_add(&in->timer);
  hal_irq_restore(irq);
}
