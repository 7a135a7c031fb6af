#include "scheduler.h"

#include <stddef.h>

#include "shutdown.h"

DECL_SHUTDOWN_REASON(TIMER_TOO_CLOSE, "Timer too close");
DECL_SHUTDOWN_REASON(OVERLOADED, "Rescheduled timer in the past");

// A timer that is later than this means that the chip is overloaded.
#define LATEST (HAL_CLOCK_HZ / 10)

// Written by foreground and timer under hal_irq_save(). The timer interrupt is not reentrant, and
// no other interrupt uses these.
static struct timer *first;
static volatile bool woken;

DECL_START(scheduler_start);
void scheduler_start(void) {
  first = NULL;
  woken = false;
}

DECL_ON_SHUTDOWN(task_wake);
void task_wake(void) { woken = true; }

bool task_woken(void) {
  if (!woken) return false;  // a wake between the read and the write must not be lost
  woken = false;
  return true;
}

static void insert(struct timer *timer) {
  struct timer **at = &first;
  while (*at != NULL && !before(timer->wake, (*at)->wake)) at = &(*at)->next;
  timer->next = *at;
  *at = timer;
}

void timer_add(struct timer *timer) {
  hal_irq_t irq = hal_irq_save();
  if (!is_shut_down() || timer->lasting) {
    if (before(timer->wake, hal_clock())) {
      shut_down(SHUTDOWN_TIMER_TOO_CLOSE);
    } else {
      insert(timer);
      if (first == timer) hal_alarm(timer->wake);
    }
  }
  hal_irq_restore(irq);
}

void timer_remove(struct timer *timer) {
  hal_irq_t irq = hal_irq_save();
  for (struct timer **at = &first; *at != NULL; at = &(*at)->next) {
    if (*at == timer) {
      *at = timer->next;
      break;
    }
  }
  hal_irq_restore(irq);
}

bool timers_run(void) {
  hal_irq_t irq = hal_irq_save();
  bool run = first == NULL || !before(first->wake + LATEST, hal_clock());
  hal_irq_restore(irq);
  return run;
}

void sched_interrupt(void) {
  while (first != NULL) {
    struct timer *timer = first;
    uint32_t now = hal_clock();
    if (before(now, timer->wake)) {
      hal_alarm(timer->wake);
      return;
    }
    if (now - timer->wake > LATEST) shut_down(SHUTDOWN_OVERLOADED);
    if (first != timer) continue;
    first = timer->next;
    if (timer->run(timer) && (!is_shut_down() || timer->lasting)) insert(timer);
  }
}
