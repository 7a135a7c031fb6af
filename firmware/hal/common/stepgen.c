#include "stepgen.h"

#include <stddef.h>

static struct axis {
  struct hal_output step, direction_pin;
  bool invert, active, stopped;
  uint8_t direction;  // level of its pin
  uint16_t pulse_ticks;
  uint32_t next, interval;  // clock of the next step; and from it to the one after
  uint16_t count;           // steps left of the move, the next one included
  int16_t add;
  int32_t end;  // position when the move is done
  struct move *oldest, *waiting, *newest;
} axes[HAL_STEPPERS];
static uint8_t axis_count;
// Steps that are late do not begin before `low_until`: drivers want the pin to be low between two
// pulses for as long as a pulse takes.
static bool late;
static uint32_t low_until;

void stepgen_start(void) {
  axis_count = 0;
  late = false;
}

bool stepgen_setup(uint8_t index, uint16_t step_pin, uint16_t direction_pin, bool invert,
                   uint16_t pulse_ticks) {
  if (index >= HAL_STEPPERS) return false;
  struct axis *axis = &axes[index];
  *axis = (struct axis){.invert = invert, .pulse_ticks = pulse_ticks};
  if (!hal_output_setup(&axis->step, step_pin, invert)) return false;
  if (!hal_output_setup(&axis->direction_pin, direction_pin, false)) return false;
  axis_count = (uint8_t)(index + 1);
  return true;
}

// Begins the next move; under hal_irq_save() or in the interrupt.
static void load(struct axis *axis) {
  struct move *move = axis->waiting;
  axis->active = move != NULL;
  if (move == NULL) return;
  axis->waiting = move->next;
  axis->interval = move->interval;
  axis->count = move->count;
  axis->add = move->add;
  axis->end += move->direction ? move->count : -(int32_t)move->count;
  if (axis->direction != move->direction) {
    axis->direction = move->direction;
    hal_output_write(&axis->direction_pin, move->direction);
  }
}

// The step after the one at axis->next.
static void advance(struct axis *axis) {
  axis->next += axis->interval;
  axis->interval += (uint32_t)(int32_t)axis->add;
}

#define NEVER INT32_MAX  // 12 s and more, which no host leaves between two steps

// Keeps the lesser of `soonest` and the ticks from `now` to a clock.
static inline void note(int32_t *soonest, uint32_t clock, uint32_t now) {
  int32_t ahead = (int32_t)(clock - now);
  if (ahead < *soonest) *soonest = ahead;
}

// The clock for the next alarm, the soonest step being so many ticks after `now`.
static uint32_t alarm_at(int32_t soonest, uint32_t now) {
  uint32_t clock = now + (uint32_t)soonest;
  return late && (int32_t)(clock - low_until) < 0 ? low_until : clock;
}

static void set_alarm(void) {
  uint32_t now = hal_clock();
  int32_t soonest = NEVER;
  for (struct axis *axis = axes; axis < axes + axis_count; ++axis)
    if (axis->active) note(&soonest, axis->next, now);
  if (soonest < NEVER) stepgen_alarm(alarm_at(soonest, now));
}

bool stepgen_interrupt(uint32_t *again) {
  uint32_t now = hal_clock();
  if (late && (int32_t)(now - low_until) >= 0) late = false;
  int32_t soonest = NEVER;  // of the axes that are not due
  uint32_t pulse_ticks = 0;
  struct axis *due[HAL_STEPPERS], **due_end = due;
  for (struct axis *axis = axes, *end = axes + axis_count; axis < end; ++axis) {
    if (!axis->active) continue;
    if ((int32_t)(axis->next - now) > 0) {
      note(&soonest, axis->next, now);
      continue;
    }
    hal_output_write(&axis->step, !axis->invert);
    if (axis->pulse_ticks > pulse_ticks) pulse_ticks = axis->pulse_ticks;
    *due_end++ = axis;
  }
  if (due_end > due) {
    uint32_t end = hal_clock() + pulse_ticks;
    int32_t own = NEVER;  // of those that are
    // What comes next is reckoned while the pulses last; but directions stay until they are over.
    for (struct axis **at = due; at < due_end; ++at) {
      if (--(*at)->count == 0) continue;
      advance(*at);
      note(&own, (*at)->next, now);
    }
    stepgen_wait(end);
    for (struct axis **at = due; at < due_end; ++at) {
      struct axis *axis = *at;
      hal_output_write(&axis->step, axis->invert);
      if (axis->count > 0) continue;
      load(axis);
      if (!axis->active) continue;
      advance(axis);
      note(&own, axis->next, now);
    }
    // The clock is read again only where it matters: that takes time.
    late = own < (int32_t)(end - now + 2 * pulse_ticks);
    if (late) {
      low_until = hal_clock() + pulse_ticks;
      late = own < (int32_t)(low_until - now);
    }
    if (own < soonest) soonest = own;
  }
  *again = alarm_at(soonest, now);
  return soonest < NEVER;
}

bool stepgen_append(uint8_t index, struct move *move, uint32_t first) {
  struct axis *axis = &axes[index];
  move->next = NULL;
  hal_irq_t irq = hal_irq_save();
  bool taken = !axis->stopped && (axis->active || (int32_t)(first - hal_clock()) >= 0);
  if (taken) {
    if (axis->newest != NULL)
      axis->newest->next = move;
    else
      axis->oldest = move;
    axis->newest = move;
    if (axis->waiting == NULL) axis->waiting = move;
    if (!axis->active) {
      load(axis);
      axis->next = first - axis->interval;
      advance(axis);
      set_alarm();
    }
  }
  hal_irq_restore(irq);
  return taken;
}

bool stepgen_active(uint8_t index) { return axes[index].active; }

// Steps left of the move under way, with their sign.
static int32_t left(const struct axis *axis) {
  if (!axis->active) return 0;
  return axis->direction ? axis->count : -(int32_t)axis->count;
}

void stepgen_stop(uint8_t index) {
  struct axis *axis = &axes[index];
  hal_irq_t irq = hal_irq_save();
  axis->end -= left(axis);
  axis->active = false;
  axis->waiting = NULL;
  axis->stopped = true;
  late = false;
  hal_irq_restore(irq);
}

void stepgen_resume(uint8_t index) { axes[index].stopped = false; }

int32_t stepgen_position(uint8_t index) {
  hal_irq_t irq = hal_irq_save();
  int32_t position = axes[index].end - left(&axes[index]);
  hal_irq_restore(irq);
  return position;
}

struct move *stepgen_reclaim(uint8_t index) {
  struct axis *axis = &axes[index];
  hal_irq_t irq = hal_irq_save();
  struct move *move = axis->oldest;
  if (move == axis->waiting) {
    move = NULL;
  } else {
    axis->oldest = move->next;
    if (axis->oldest == NULL) axis->newest = NULL;
  }
  hal_irq_restore(irq);
  return move;
}
