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

// A value to come; it takes one slot of the pool.
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
  // The foreground's, while the output is at rest.
  uint32_t full;  // the value that means fully on: the cycle of software PWM
  uint32_t default_value, max_duration;
  // Written by foreground and timer under hal_irq_save().
  struct change *first, *last;
  uint32_t value;
  uint32_t expires;                        // if `watched`
  uint32_t toggle;                         // the next edge of software PWM, if `toggling`
  uint32_t rest;                           // and the ticks off of each cycle
  bool watched, toggling, level, waiting;  // waiting: the timer is going
  // When its duration has passed while the board survives its host: this value, or the present one
  // if that is nearer to the default, and the default when the seconds are over.
  uint32_t kept_value;
  uint8_t kept_seconds, left;
  bool kept, keeping;
};

// Sets the value of an output when the host is gone. Foreground.
void output_keep(struct output *output, uint32_t value, uint8_t seconds);
// Outputs that are not to be kept at all go to their default. Timer context.
void outputs_hold_none(void);
