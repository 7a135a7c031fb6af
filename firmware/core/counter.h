// Counts the edges of an input, such as the pulses of a fan's tachometer.
#pragma once
#include <stdbool.h>
#include <stdint.h>

#include "object.h"
#include "scheduler.h"

struct counter {
  struct object object;
  struct timer timer;
  struct hal_input input;
  uint32_t poll_ticks, sample_ticks;
  // The timer writes these; the foreground reads them under hal_irq_save(), and clears `due`.
  uint32_t next_sample;  // clock of the next report
  uint32_t count, count_clock;
  bool level, due;
};
