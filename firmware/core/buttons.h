// Buttons and encoders: up to eight inputs that are sampled together. A level counts when two
// samples in a row agree; other inputs do not matter. Each new state is kept until the host
// acknowledges it. Unacknowledged states are reported again after a number of samples.
#pragma once
#include <stdbool.h>
#include <stdint.h>

#include "hal.h"
#include "object.h"
#include "scheduler.h"

#define BUTTONS_MAX 8
#define BUTTON_STATES 8

struct buttons {
  struct object object;
  struct timer timer;
  // Written by the foreground while the timer is stopped.
  uint32_t rest_ticks;
  uint8_t count, invert, retransmit_count;
  uint8_t added;  // one bit for each input with a pin
  // Written by foreground and timer under hal_irq_save().
  uint8_t seen, reported;                // last sample; last state
  uint8_t unacknowledged, acknowledged;  // number of states
  uint8_t wait;                          // samples until unacknowledged states are reported again
  bool unreported;
  uint8_t states[BUTTON_STATES];
  struct hal_input inputs[];  // size: `count`
};
