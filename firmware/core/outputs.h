// Outputs that follow a queue of values: digital ones, with software PWM if they are given a cycle,
// and those of the chip's own PWM.
//
// A value other than the default must be renewed within `max_duration` ticks (0: need not), or the
// board shuts down. A value of software PWM is the ticks on of each cycle; the cycle begins anew
// with each value.
#pragma once
#include <stdbool.h>
#include <stdint.h>

#include "hal.h"
#include "object.h"
#include "scheduler.h"

// A scheduled value; it takes one slot of the pool.
struct change {
  struct change *next;
  uint32_t clock, value;
};
_Static_assert(sizeof(struct change) <= sizeof(struct move), "a change fits in a slot");

struct output {
  struct object object;
  union {
    struct hal_output digital;
    struct hal_pwm pwm;
  };
  uint16_t pin;
  struct timer timer;
  // Written by the foreground while the output is idle.
  uint32_t full;  // fully on: the cycle of software PWM in ticks
  uint32_t default_value, max_duration;
  // Written by foreground and timer under hal_irq_save().
  struct change *first, *last;
  uint32_t value;
  uint32_t expires;                        // valid if `watched`
  uint32_t toggle;                         // next edge of software PWM; valid if `toggling`
  uint32_t rest;                           // ticks off in each cycle
  bool watched, toggling, level, waiting;  // the timer runs
  // For an output whose duration passes while the board survives its host: the output takes this
  // value, or keeps its value if that is closer to the default. After `seconds` it takes the
  // default.
  uint32_t kept_value;
  uint8_t kept_seconds, left;
  bool kept, keeping;
};

// Sets the value of an output for the time without a host. Foreground.
void output_keep(struct output *output, uint32_t value, uint8_t seconds);
// Sets outputs that are not kept to their default. Timer context.
void outputs_hold_none(void);
