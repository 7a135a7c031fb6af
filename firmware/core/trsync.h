// Groups of motors that stop together: at once when an endstop, the host or a timeout triggers.
#pragma once
#include <stdbool.h>
#include <stdint.h>

#include "object.h"
#include "scheduler.h"

struct stepper;

struct trsync {
  struct object object;
  struct timer report, timeout;  // the first motor continues until trsync_trigger
  struct stepper *motors;        // written by the foreground under hal_irq_save()
  uint32_t report_ticks;         // written by the foreground while `report` is stopped
  // Written by foreground and timer under hal_irq_save().
  uint32_t clock;  // of the last event
  uint8_t reason;
  bool armed, unreported;
  uint8_t expire_reason;  // written by the foreground while not armed
};

// Stops the motors if the group is armed. Any context.
void trsync_trigger(struct trsync *group, uint8_t reason);
