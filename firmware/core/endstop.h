// Endstops, which trigger a group of motors. An endstop is sampled every `rest_ticks`;
// `sample_count` equal samples, `sample_ticks` apart, trigger it.
#pragma once
#include <stdbool.h>
#include <stdint.h>

#include "hal.h"
#include "object.h"
#include "scheduler.h"
#include "trsync.h"

struct endstop {
  struct object object;
  struct hal_input input;
  struct timer timer;
  // Written by the foreground while not armed.
  struct trsync *group;
  uint32_t sample_ticks, rest_ticks;
  uint8_t sample_count, reason;
  bool wanted;
  // Written by foreground and timer under hal_irq_save().
  bool armed;
  uint8_t hits;
  uint32_t first_hit;
};
