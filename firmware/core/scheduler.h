// Timers by clock: a sorted list, run by the alarm in timer context.
#pragma once
#include <stdbool.h>
#include <stdint.h>

#include "declare.h"
#include "declared.h"
#include "hal.h"

struct timer {
  struct timer *next;
  uint32_t wake;
  // Timer context. True if it has to run again at the `wake` it has set, which may be past.
  bool (*run)(struct timer *timer);
  bool lasting;  // runs on through a shutdown
};

// True if clock `a` is before clock `b`.
static inline bool before(uint32_t a, uint32_t b) { return (int32_t)(a - b) < 0; }

// Called by the hardware layer: see hal.h.
void sched_interrupt(void);

// Sets a timer going at timer->wake; it must not be going. Nothing happens while shut down, unless
// it is lasting; a clock that is past shuts down. Any context but the timer's own run().
void timer_add(struct timer *timer);
// Stops a timer, going or not. Any context.
void timer_remove(struct timer *timer);

// Whether timers run: the watchdog is fed for that too. Foreground.
bool timers_run(void);

// Makes the main loop run all tasks (DECL_TASK), as a shutdown does. Any context.
void task_wake(void);
// True once after task_wake(). Foreground.
bool task_woken(void);
