#include "endstop.h"

#include <stddef.h>

#include "command.h"
#include "shutdown.h"
#include "survive_state.h"

DECL_SHUTDOWN_REASON(INPUT_PIN, "Not a valid input pin");
DECL_REPORT("endstop_state oid=%c homing=%c next_clock=%u pin_value=%c");

static bool run(struct timer *timer) {
  struct endstop *endstop = (struct endstop *)((char *)timer - offsetof(struct endstop, timer));
  if (hal_input_read(&endstop->input) != endstop->wanted) {
    if (endstop->hits > 0) timer->wake = endstop->first_hit;
    timer->wake += endstop->rest_ticks;
    endstop->hits = 0;
    return true;
  }
  if (endstop->hits++ == 0) endstop->first_hit = timer->wake;
  if (endstop->hits < endstop->sample_count) {
    timer->wake += endstop->sample_ticks;
    return true;
  }
  endstop->armed = false;
  trsync_trigger(endstop->group, endstop->reason);
  return false;
}

static void disarm(void *object) {
  struct endstop *endstop = object;
  timer_remove(&endstop->timer);
  endstop->armed = false;
}
static const struct object_kind kind = {OBJECT_ENDSTOP, disarm};

DECL_COMMAND(command_config_endstop, "config_endstop oid=%c pin=%u pull_up=%c", 0);
void command_config_endstop(const uint32_t *args) {
  struct endstop *endstop = object_add(args[0], &kind, sizeof *endstop);
  if (endstop == NULL) return;
  endstop->timer.run = run;
  if (args[1] > 0xffff || !hal_input_setup(&endstop->input, (uint16_t)args[1], args[2] != 0))
    shut_down(SHUTDOWN_INPUT_PIN);
}

DECL_COMMAND(command_endstop_home,
             "endstop_home oid=%c clock=%u sample_ticks=%u sample_count=%c rest_ticks=%u"
             " pin_value=%c trsync_oid=%c trigger_reason=%c",
             0);
void command_endstop_home(const uint32_t *args) {
  struct endstop *endstop = object_get(args[0], OBJECT_ENDSTOP);
  if (endstop == NULL || !check_finalized()) return;
  hal_irq_t irq = hal_irq_save();
  disarm(endstop);
  hal_irq_restore(irq);
  if (args[3] == 0) return;
  struct trsync *group = object_get(args[6], OBJECT_TRSYNC);
  if (group == NULL) return;
  if (args[4] < HAL_SHORTEST_PERIOD || (args[3] > 1 && args[2] < HAL_SHORTEST_PERIOD)) {
    shut_down(SHUTDOWN_PERIOD_TOO_SHORT);
    return;
  }
  endstop->group = group;
  endstop->sample_ticks = args[2];
  endstop->sample_count = (uint8_t)args[3];
  endstop->rest_ticks = args[4];
  endstop->wanted = args[5] != 0;
  endstop->reason = (uint8_t)args[7];
  endstop->hits = 0;
  endstop->timer.wake = survive_in_time(args[1]);
  irq = hal_irq_save();
  endstop->armed = true;
  timer_add(&endstop->timer);
  if (is_shut_down()) endstop->armed = false;
  hal_irq_restore(irq);
}

DECL_COMMAND(command_endstop_query_state, "endstop_query_state oid=%c", 0);
void command_endstop_query_state(const uint32_t *args) {
  struct endstop *endstop = object_get(args[0], OBJECT_ENDSTOP);
  if (endstop == NULL) return;
  hal_irq_t irq = hal_irq_save();
  // The host computes the time of the trigger: one sample after the last open one.
  uint32_t clock =
      endstop->hits > 0 ? endstop->first_hit + endstop->rest_ticks : endstop->timer.wake;
  uint32_t values[] = {args[0], endstop->armed, clock, hal_input_read(&endstop->input)};
  hal_irq_restore(irq);
  report(REPORT_ENDSTOP_STATE, values, 4);
}
