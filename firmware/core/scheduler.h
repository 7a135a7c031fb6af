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
  // Timer context. Returns true to run again at the `wake` that it has set, which may be past.
  bool (*run)(struct timer *timer);
  bool lasting;  // continues during a shutdown
};

// True if clock `a` is before clock `b`.
static inline bool before(uint32_t a, uint32_t b) { return (int32_t)(a - b) < 0; }

// Called by the hardware layer, see hal.h.
void sched_interrupt(void);

// Starts a stopped timer at timer->wake. During a shutdown only lasting timers start. A clock in
// the past shuts down. Any context except the timer's own run().
void timer_add(struct timer *timer);
// Stops a timer, running or not. Any context.
void timer_remove(struct timer *timer);

// Returns whether timers run; otherwise the watchdog is not fed. Foreground.
bool timers_run(void);

// Makes the main loop run all tasks (DECL_TASK) once. A shutdown does the same. Any context.
void task_wake(void);
// Returns true once after task_wake(). Foreground.
bool task_woken(void);
