// Analog inputs: sums of samples, reported at regular times. `range_checks` sums in a row outside
// their range shut the board down, and with it every heater; this check continues after a shutdown.
#pragma once
#include <stdbool.h>
#include <stdint.h>

#include "hal.h"
#include "object.h"
#include "scheduler.h"

#define ANALOG_VALUES_MAX 24

// A sum of `sample_count` samples, `sample_ticks` apart, every `rest_ticks`.
struct analog_query {
  uint32_t sample_ticks, rest_ticks;
  uint16_t minimum, maximum;
  uint8_t sample_count;  // 0: no more samples
  uint8_t range_checks;  // 0: no reports
  uint8_t report_size;   // bytes of a report
};

struct analog_in {
  struct object object;
  struct hal_analog analog;
  struct timer timer;
  struct analog_query query;  // written by the foreground while the timer is stopped
  // Written by the timer; by the foreground under hal_irq_save().
  uint32_t due;    // number of the sample that is read next
  uint32_t begin;  // first sample of the next sum
  uint32_t sum;
  uint8_t samples, outside;
  bool watching;        // sums have a range; written by the foreground
  uint8_t size, ready;  // bytes in `values`, and bytes of a report (0: no report)
  uint8_t values[2 * ANALOG_VALUES_MAX];
};

// Restarts. `args` are those of query_analog_in up to rest_ticks, `range` those from min_value on.
// Foreground.
void analog_in_query(const uint32_t *args, uint8_t report_size, const uint32_t *range);
// Reports `size` bytes of sums, low byte first: in analog_report.c.
void analog_in_report(uint8_t oid, uint32_t next_clock, const uint8_t *values, uint8_t size);
