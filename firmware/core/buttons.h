// Buttons and encoders: up to eight inputs sampled together. A level counts if two samples in a row
// agree, whatever the other inputs do. Each new state is kept until the host acknowledges it;
// unacknowledged states are reported again after so many samples.
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
  // The foreground's, while the timer does not run.
  uint32_t rest_ticks;
  uint8_t count, invert, retransmit_count;
  uint8_t added;  // a bit for each input that has its pin
  // Written by foreground and timer under hal_irq_save().
  uint8_t seen, told;                    // the last look; the last state kept
  uint8_t unacknowledged, acknowledged;  // how many states
  uint8_t wait;                          // samples until they are reported again, if there are any
  bool unreported;
  uint8_t states[BUTTON_STATES];
  struct hal_input inputs[];  // `count`
};
