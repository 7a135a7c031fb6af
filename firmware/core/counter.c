#include "counter.h"

#include <stddef.h>

#include "command.h"
#include "shutdown.h"

DECL_REPORT("counter_state oid=%c next_clock=%u count=%u count_clock=%u");

static bool run(struct timer *timer) {
  struct counter *counter = (struct counter *)((char *)timer - offsetof(struct counter, timer));
  bool level = hal_input_read(&counter->input);
  if (level != counter->level) {
    counter->level = level;
    ++counter->count;
    counter->count_clock = timer->wake;
  }
  if (!before(timer->wake, counter->next_sample)) {
    counter->next_sample = timer->wake + counter->sample_ticks;
    counter->due = true;
    task_wake();
  }
  timer->wake += counter->poll_ticks;
  return true;
}

static void stop(void *object) { timer_remove(&((struct counter *)object)->timer); }
static const struct object_kind kind = {OBJECT_COUNTER, stop};

DECL_TASK(counter_task, INPUTS);
void counter_task(void) {
  struct counter *counter;
  for (int16_t oid = -1; (counter = object_next(&oid, OBJECT_COUNTER)) != NULL;) {
    hal_irq_t irq = hal_irq_save();
    bool due = counter->due;
    uint32_t next = counter->next_sample, count = counter->count, clock = counter->count_clock;
    counter->due = false;
    hal_irq_restore(irq);
    if (due) report(REPORT_COUNTER_STATE, (uint32_t[]){(uint8_t)oid, next, count, clock}, 4);
  }
}

DECL_COMMAND(command_config_counter, "config_counter oid=%c pin=%u pull_up=%c", 0);
void command_config_counter(const uint32_t *args) {
  struct counter *counter = object_add(args[0], &kind, sizeof *counter);
  if (counter == NULL) return;
  counter->timer.run = run;
  if (args[1] > 0xffff || !hal_input_setup(&counter->input, (uint16_t)args[1], args[2] != 0))
    shut_down(SHUTDOWN_INPUT_PIN);
}

DECL_COMMAND(command_query_counter, "query_counter oid=%c clock=%u poll_ticks=%u sample_ticks=%u",
             0);
void command_query_counter(const uint32_t *args) {
  struct counter *counter = object_get(args[0], OBJECT_COUNTER);
  if (counter == NULL || !check_finalized()) return;
  timer_remove(&counter->timer);
  if (args[2] == 0) return;
  if (args[2] < HAL_SHORTEST_PERIOD) {
    shut_down(SHUTDOWN_PERIOD_TOO_SHORT);
    return;
  }
  counter->timer.wake = args[1];
  counter->poll_ticks = args[2];
  counter->sample_ticks = args[3];
  counter->next_sample = args[1] + args[3];
  counter->level = hal_input_read(&counter->input);
  counter->due = false;
  timer_add(&counter->timer);
}
