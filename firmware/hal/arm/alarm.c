#include "alarm.h"

#include "cortex.h"
#include "hal.h"
#include "scheduler.h"
#include "stepgen.h"

#define RATIO (CHIP_CORE_HZ / HAL_CLOCK_HZ)
_Static_assert(RATIO *HAL_CLOCK_HZ == CHIP_CORE_HZ, "the core's clock is no multiple of the clock");
_Static_assert(HAL_CLOCK_HZ == CHIP_CLOCK_HZ, "the chip's clock has another frequency");
#define FARTHEST ((int32_t)(SYST_MAX / RATIO))

// Accessed under hal_irq_save(), or in the interrupt of SysTick, which has the highest priority.
static struct alarm {
  uint32_t clock;
  bool set;
} steps, timers;

static inline bool due(const struct alarm *alarm, uint32_t now) {
  return alarm->set && (int32_t)(alarm->clock - now) <= 0;
}

// An alarm beyond the range of SysTick fires early; the core then asks again.
static inline void arm(void) {
  uint32_t now = chip_clock();
  int32_t first = FARTHEST;
  if (steps.set && (int32_t)(steps.clock - now) < first) first = (int32_t)(steps.clock - now);
  if (timers.set && (int32_t)(timers.clock - now) < first) first = (int32_t)(timers.clock - now);
  if (first <= 0) {
    SCB_ICSR = ICSR_PENDSTSET;
    return;
  }
  SYST_RVR = (uint32_t)first * RATIO;
  SYST_CVR = 0;
  SYST_CSR = SYST_ON;
}

static void set(struct alarm *alarm, uint32_t clock) {
  hal_irq_t irq = hal_irq_save();
  alarm->clock = clock;
  alarm->set = true;
  arm();
  hal_irq_restore(irq);
}

void hal_alarm(uint32_t clock) { set(&timers, clock); }
void stepgen_alarm(uint32_t clock) { set(&steps, clock); }

void alarm_start(void) {
  steps.set = timers.set = false;
  SYST_CSR = 0;
  SCB_SHPR3 = SHPR3_PENDSV_LAST;  // and SysTick first
}

void alarm_interrupt(void) {
  SYST_CSR = 0;
  uint32_t now = chip_clock();
  if (due(&steps, now)) steps.set = stepgen_interrupt(now, &steps.clock);
  if (due(&timers, now)) {
    timers.set = false;
    SCB_ICSR = ICSR_PENDSVSET;
  }
  arm();
}

void timer_interrupt(void) { sched_interrupt(); }
