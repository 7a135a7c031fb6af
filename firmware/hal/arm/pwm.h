// The cycle of timers that count to any 16-bit top at a divided clock.
#pragma once
#include <stdbool.h>
#include <stdint.h>

#define PWM_TOP_MAX 65535

struct pwm_cycle {
  uint32_t divider, top;  // cycle = divider · top ticks of the timer's clock
};

// The achievable cycle nearest to `cycle` ticks, for a timer at `timer_hz` with one count for each
// step of a value. Dividers are 1 to `dividers` or, with `powers`, the powers of two up to
// `dividers`.
struct pwm_cycle pwm_cycle(uint32_t cycle, uint32_t timer_hz, uint32_t dividers, bool powers);
