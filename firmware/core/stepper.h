// Motors: what the host queues for the step generator.
#pragma once
#include <stdbool.h>
#include <stdint.h>

#include "hal.h"
#include "object.h"

struct trsync;

struct stepper {
  struct object object;
  // The foreground's, under hal_irq_save(): see trsync.h.
  struct trsync *group;  // or null
  struct stepper *next_of_group;
  uint32_t last;                  // clock of the last step queued; the foreground's
  uint8_t axis, direction;        // the foreground's
  // Steps are ignored until reset_step_clock. Written by foreground and timer.
  volatile bool halted;
};

void steppers_start(void);
// Halts a motor at once. Any context.
void stepper_halt(struct stepper *stepper);
// Gives the moves that the generator has done with back to the pool. Foreground.
void steppers_reclaim(void);
