#include "buttons.h"

#include <stddef.h>
#include <string.h>

#include "command.h"
#include "shutdown.h"

DECL_SHUTDOWN_REASON(TOO_MANY_BUTTONS, "Max of 8 buttons");
DECL_SHUTDOWN_REASON(NO_SUCH_BUTTON, "Set button past maximum button count");
DECL_REPORT("buttons_state oid=%c ack_count=%c state=%*s");

static void tell(struct buttons *buttons) {
  buttons->wait = buttons->retransmit_count;
  buttons->unreported = true;
  task_wake();
}

static bool run(struct timer *timer) {
  struct buttons *buttons = (struct buttons *)((char *)timer - offsetof(struct buttons, timer));
  uint8_t state = 0;
  for (uint8_t i = 0; i < buttons->count; ++i)
    if (buttons->added >> i & 1) state |= (uint8_t)(hal_input_read(&buttons->inputs[i]) << i);
  state ^= buttons->invert;
  uint8_t settled = (uint8_t)~(state ^ buttons->seen);  // bits that are equal in two samples
  uint8_t next = (uint8_t)((buttons->reported & ~settled) | (state & settled));
  buttons->seen = state;
  if (next != buttons->reported && buttons->unacknowledged < BUTTON_STATES) {
    buttons->reported = buttons->states[buttons->unacknowledged++] = next;
    tell(buttons);
  } else if (buttons->unacknowledged > 0 && buttons->retransmit_count > 0 && --buttons->wait == 0) {
    tell(buttons);
  }
  timer->wake += buttons->rest_ticks;
  return true;
}

static void stop(void *object) { timer_remove(&((struct buttons *)object)->timer); }
static const struct object_kind kind = {OBJECT_BUTTONS, stop};

// Reports new states, and states that the host has not acknowledged.
DECL_TASK(buttons_task, INPUTS);
void buttons_task(void) {
  struct buttons *buttons;
  for (int16_t oid = -1; (buttons = object_next(&oid, OBJECT_BUTTONS)) != NULL;) {
    uint8_t states[BUTTON_STATES];
    hal_irq_t irq = hal_irq_save();
    bool due = buttons->unreported;
    uint8_t size = buttons->unacknowledged, acknowledged = buttons->acknowledged;
    memcpy(states, buttons->states, sizeof states);
    buttons->unreported = false;
    hal_irq_restore(irq);
    // If the console is full, the state is sent again later, like one that was lost on the wire.
    if (due)
      report_bytes(REPORT_BUTTONS_STATE, (uint32_t[]){(uint8_t)oid, acknowledged}, 2, states, size);
  }
}

DECL_COMMAND(command_config_buttons, "config_buttons oid=%c button_count=%c", 0);
void command_config_buttons(const uint32_t *args) {
  uint8_t count = (uint8_t)args[1];
  if (count > BUTTONS_MAX) {
    shut_down(SHUTDOWN_TOO_MANY_BUTTONS);
    return;
  }
  struct buttons *buttons =
      object_add(args[0], &kind, sizeof *buttons + count * sizeof(struct hal_input));
  if (buttons == NULL) return;
  buttons->timer.run = run;
  buttons->count = count;
}

DECL_COMMAND(command_buttons_add, "buttons_add oid=%c pos=%c pin=%u pull_up=%c", 0);
void command_buttons_add(const uint32_t *args) {
  struct buttons *buttons = object_get(args[0], OBJECT_BUTTONS);
  if (buttons == NULL) return;
  if (args[1] >= buttons->count)
    shut_down(SHUTDOWN_NO_SUCH_BUTTON);
  else if (args[2] > 0xffff ||
           !hal_input_setup(&buttons->inputs[args[1]], (uint16_t)args[2], args[3] != 0))
    shut_down(SHUTDOWN_INPUT_PIN);
  else
    buttons->added |= (uint8_t)(1 << args[1]);
}

DECL_COMMAND(command_buttons_query,
             "buttons_query oid=%c clock=%u rest_ticks=%u retransmit_count=%c invert=%c", 0);
void command_buttons_query(const uint32_t *args) {
  struct buttons *buttons = object_get(args[0], OBJECT_BUTTONS);
  if (buttons == NULL || !check_finalized()) return;
  timer_remove(&buttons->timer);
  if (args[2] == 0) return;
  if (args[2] < HAL_SHORTEST_PERIOD) {
    shut_down(SHUTDOWN_PERIOD_TOO_SHORT);
    return;
  }
  buttons->timer.wake = args[1];
  buttons->rest_ticks = args[2];
  buttons->retransmit_count = (uint8_t)args[3];
  buttons->invert = (uint8_t)args[4];
  buttons->seen = buttons->reported = 0;
  buttons->unacknowledged = buttons->acknowledged = 0;
  timer_add(&buttons->timer);
}

DECL_COMMAND(command_buttons_ack, "buttons_ack oid=%c count=%c", 0);
void command_buttons_ack(const uint32_t *args) {
  struct buttons *buttons = object_get(args[0], OBJECT_BUTTONS);
  if (buttons == NULL) return;
  hal_irq_t irq = hal_irq_save();
  uint8_t count = (uint8_t)args[1];
  if (count > buttons->unacknowledged) count = buttons->unacknowledged;
  buttons->acknowledged += count;
  buttons->unacknowledged -= count;
  memmove(buttons->states, buttons->states + count, buttons->unacknowledged);
  hal_irq_restore(irq);
}
