// Analog inputs: sums of samples, reported at regular times. `range_checks` sums in a row outside
// their range shut the board down, and with it every heater; that watch goes on after a shutdown.
#pragma once
#include <stdbool.h>
#include <stdint.h>

#include "hal.h"
#include "object.h"
#include "scheduler.h"

#define ANALOG_VALUES_MAX 24

struct analog_in {
  struct object object;
  struct hal_analog analog;
  struct timer timer;
  // The foreground's, while the timer stands still.
  uint32_t sample_ticks, rest_ticks;
  uint16_t minimum, maximum;
  uint8_t sample_count, range_checks, report_size;
  // Written by the timer; by the foreground under hal_irq_save().
  uint32_t due;  // the sample that is waited for
  uint32_t begin;  // first sample of the sum that comes next
  uint32_t sum;
  uint8_t samples, outside;
  uint8_t size, ready;  // bytes of `values`; and how many of them make a report, 0 until then
  uint8_t values[2 * ANALOG_VALUES_MAX];
};

// Reports what is ready. Foreground.
void analog_in_task(void);
