#include "shutdown.h"

#include "command.h"
#include "hal.h"
#include "object.h"
#include "scheduler.h"
#include "spi.h"
#include "survive.h"

DECL_SHUTDOWN(EMERGENCY_STOP, "Command request");
DECL_REPORT("shutdown clock=%u static_string_id=%hu");
DECL_REPORT("is_shutdown static_string_id=%hu");

// Written by foreground and timer under hal_irq_save().
static volatile uint8_t reason;  // 0 while at work
static volatile bool unreported;
static uint32_t stopped_at;

void shutdown_start(void) {
  reason = 0;
  unreported = false;
}

void shut_down(uint8_t why) {
  hal_irq_t irq = hal_irq_save();
  if (reason == 0) {
    reason = why;
    stopped_at = hal_clock();
    unreported = true;
    objects_shut_down();
    task_wake();
  }
  hal_irq_restore(irq);
}

bool is_shut_down(void) { return reason != 0; }

uint8_t shutdown_reason(void) { return reason; }

void report_refusal(void) { report(REPORT_IS_SHUTDOWN, (uint32_t[]){reason}, 1); }

void shutdown_task(void) {
  if (!unreported) return;
  if (report(REPORT_SHUTDOWN, (uint32_t[]){stopped_at, reason}, 2))
    unreported = false;
  else
    task_wake();
}

DECL_COMMAND(command_emergency_stop, "emergency_stop", IN_SHUTDOWN);
void command_emergency_stop(const uint32_t *args) {
  (void)args;
  shut_down(SHUTDOWN_EMERGENCY_STOP);
  shutdown_task();
}

DECL_COMMAND(command_clear_shutdown, "clear_shutdown", IN_SHUTDOWN);
void command_clear_shutdown(const uint32_t *args) {
  (void)args;
  shutdown_task();
  survive_task();
  spi_send_last();
  unreported = false;  // if the console has no room: what it would tell later is not so any more
  reason = 0;
}
