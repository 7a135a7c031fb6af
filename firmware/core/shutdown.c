#include "shutdown.h"

#include "hal.h"
#include "hooks.h"

// Written by foreground and timer under hal_irq_save().
static volatile uint8_t reason;  // 0: not shut down
static uint32_t stopped_at;

DECL_START(shutdown_start);
void shutdown_start(void) { reason = 0; }

void shut_down(uint8_t why) {
  hal_irq_t irq = hal_irq_save();
  if (reason == 0) {
    reason = why;
    stopped_at = hal_clock();
    hooks_shut_down();
  }
  hal_irq_restore(irq);
}

bool is_shut_down(void) { return reason != 0; }

uint8_t shutdown_reason(void) { return reason; }

uint32_t shutdown_clock(void) { return stopped_at; }

void shutdown_clear(void) { reason = 0; }
