// Commands of the shutdown, and its report.
#include "command.h"
#include "hooks.h"
#include "scheduler.h"
#include "shutdown.h"

DECL_SHUTDOWN_REASON(EMERGENCY_STOP, "Command request");
DECL_REPORT("shutdown clock=%u static_string_id=%hu");
DECL_REPORT("is_shutdown static_string_id=%hu");  // command.c calls it for a refused command

// Set by any context under hal_irq_save(), cleared by the foreground.
static volatile bool report_pending;

DECL_START(shutdown_report_none);
void shutdown_report_none(void) { report_pending = false; }

DECL_ON_SHUTDOWN(shutdown_report_soon);
void shutdown_report_soon(void) { report_pending = true; }

DECL_TASK(shutdown_report, SHUTDOWN);
void shutdown_report(void) {
  if (!report_pending) return;
  if (report(REPORT_SHUTDOWN, (uint32_t[]){shutdown_clock(), shutdown_reason()}, 2))
    report_pending = false;
  else
    task_wake();
}

DECL_COMMAND(command_emergency_stop, "emergency_stop", IN_SHUTDOWN);
void command_emergency_stop(const uint32_t *args) {
  (void)args;
  shut_down(SHUTDOWN_EMERGENCY_STOP);
  shutdown_report();
}

DECL_COMMAND(command_clear_shutdown, "clear_shutdown", IN_SHUTDOWN);
void command_clear_shutdown(const uint32_t *args) {
  (void)args;
  shutdown_report();
  hooks_clear_shutdown();
  report_pending = false;  // also if the console was full: the report would be stale
  shutdown_clear();
}
