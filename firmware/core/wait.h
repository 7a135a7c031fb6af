// Short waits in the foreground, or under hal_irq_save().
#pragma once
#include <stdint.h>

#include "hal.h"
#include "scheduler.h"

#ifndef HAL_WAIT
static inline void wait(uint16_t ticks) {
  uint32_t end = hal_clock() + ticks;
  while (before(hal_clock(), end)) continue;
}
#define HAL_WAIT(ticks) wait(ticks)
#endif

// Maximum duration of half a bit of a software bus: 50 us, so that a message ends before the
// watchdog resets the chip.
#define LONGEST_PULSE (HAL_CLOCK_HZ / 20000 < 0x7fff ? HAL_CLOCK_HZ / 20000 : 0x7fff)
