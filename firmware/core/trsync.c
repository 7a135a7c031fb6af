#include "trsync.h"

#include <stddef.h>

#include "command.h"
#include "shutdown.h"
#include "stepper.h"
#include "survive_state.h"

DECL_SHUTDOWN_REASON(PERIOD_TOO_SHORT, "Period too short for this board");
DECL_REPORT("trsync_state oid=%c can_trigger=%c trigger_reason=%c clock=%u");

static void note(struct trsync *group) {
  group->clock = hal_clock();
  group->unreported = true;
  task_wake();
}

static bool run_report(struct timer *timer) {
  struct trsync *group = (struct trsync *)((char *)timer - offsetof(struct trsync, report));
  timer->wake += group->report_ticks;
  note(group);
  return true;
}

static bool run_timeout(struct timer *timer) {
  struct trsync *group = (struct trsync *)((char *)timer - offsetof(struct trsync, timeout));
  trsync_trigger(group, group->expire_reason);
  return false;
}

// The state at the configuration; under hal_irq_save().
static void clear(struct trsync *group) {
  timer_remove(&group->report);
  timer_remove(&group->timeout);
  while (group->motors != NULL) {
    struct stepper *motor = group->motors;
    group->motors = motor->next_of_group;
    motor->group = NULL;
  }
  group->armed = group->unreported = false;
  group->reason = 0;
}

static void shut_down_trsync(void *object) { clear(object); }
static const struct object_kind kind = {OBJECT_TRSYNC, shut_down_trsync};

void trsync_trigger(struct trsync *group, uint8_t reason) {
  hal_irq_t irq = hal_irq_save();
  if (group->armed) {
    group->armed = false;
    group->reason = reason;
    timer_remove(&group->timeout);
    for (struct stepper *motor = group->motors; motor != NULL; motor = motor->next_of_group)
      stepper_halt(motor);
    note(group);
  }
  hal_irq_restore(irq);
}

// Returns false if the console is full.
static bool report_state(struct trsync *group, uint8_t oid) {
  hal_irq_t irq = hal_irq_save();
  uint32_t values[] = {oid, group->armed, group->reason, group->clock};
  group->unreported = false;
  hal_irq_restore(irq);
  if (report(REPORT_TRSYNC_STATE, values, 4)) return true;
  irq = hal_irq_save();
  if (!is_shut_down()) group->unreported = true;
  hal_irq_restore(irq);
  return false;
}

// Reports the events since the last call.
DECL_TASK(trsync_task, MOTORS);
void trsync_task(void) {
  struct trsync *group;
  for (int16_t oid = -1; (group = object_next(&oid, OBJECT_TRSYNC)) != NULL;)
    if (group->unreported && !report_state(group, (uint8_t)oid)) task_wake();
}

DECL_COMMAND(command_config_trsync, "config_trsync oid=%c", 0);
void command_config_trsync(const uint32_t *args) {
  struct trsync *group = object_add(args[0], &kind, sizeof *group);
  if (group == NULL) return;
  group->report.run = run_report;
  group->timeout.run = run_timeout;
}

DECL_COMMAND(command_stepper_stop_on_trigger, "stepper_stop_on_trigger oid=%c trsync_oid=%c", 0);
void command_stepper_stop_on_trigger(const uint32_t *args) {
  struct stepper *motor = object_get(args[0], OBJECT_STEPPER);
  if (motor == NULL) return;
  struct trsync *group = object_get(args[1], OBJECT_TRSYNC);
  if (group == NULL) return;
  hal_irq_t irq = hal_irq_save();
  if (motor->group != NULL) {
    struct stepper **at = &motor->group->motors;
    while (*at != motor) at = &(*at)->next_of_group;
    *at = motor->next_of_group;
  }
  if (!is_shut_down()) {
    motor->group = group;
    motor->next_of_group = group->motors;
    group->motors = motor;
  }
  hal_irq_restore(irq);
}

DECL_COMMAND(command_trsync_start,
             "trsync_start oid=%c report_clock=%u report_ticks=%u expire_reason=%c", 0);
void command_trsync_start(const uint32_t *args) {
  struct trsync *group = object_get(args[0], OBJECT_TRSYNC);
  if (group == NULL || !check_finalized()) return;
  if (args[2] != 0 && args[2] < HAL_SHORTEST_PERIOD) {
    shut_down(SHUTDOWN_PERIOD_TOO_SHORT);
    return;
  }
  hal_irq_t irq = hal_irq_save();
  clear(group);
  group->armed = !is_shut_down();
  group->expire_reason = (uint8_t)args[3];
  group->report_ticks = args[2];
  group->report.wake = survive_in_time(args[1]);
  if (args[2] != 0) timer_add(&group->report);
  hal_irq_restore(irq);
}

DECL_COMMAND(command_trsync_set_timeout, "trsync_set_timeout oid=%c clock=%u", 0);
void command_trsync_set_timeout(const uint32_t *args) {
  struct trsync *group = object_get(args[0], OBJECT_TRSYNC);
  if (group == NULL || !check_finalized()) return;
  hal_irq_t irq = hal_irq_save();
  if (group->armed) {
    timer_remove(&group->timeout);
    group->timeout.wake = survive_in_time(args[1]);
    timer_add(&group->timeout);
  }
  hal_irq_restore(irq);
}

DECL_COMMAND(command_trsync_trigger, "trsync_trigger oid=%c reason=%c", 0);
void command_trsync_trigger(const uint32_t *args) {
  struct trsync *group = object_get(args[0], OBJECT_TRSYNC);
  if (group == NULL || !check_finalized()) return;
  trsync_trigger(group, (uint8_t)args[1]);
  hal_irq_t irq = hal_irq_save();
  timer_remove(&group->report);
  group->clock = hal_clock();
  hal_irq_restore(irq);
  if (!report_state(group, (uint8_t)args[0])) task_wake();
}
