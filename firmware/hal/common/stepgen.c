#include "stepgen.h"

#include <stddef.h>

// 30 µs, for which the interrupt waits.
#define LONGEST_PULSE (HAL_CLOCK_HZ / 1000000 * 30)

static struct axis {
  struct axis *later;  // first of the moving axes: the one with the next step
  struct axis *also;   // one more, with a pulse in progress
  bool active, invert, stopped;
  uint8_t direction;        // level of the step pin
  uint32_t next, interval;  // clock of the next step; interval to the step after it
  int32_t add;
  uint32_t count;  // remaining steps of the move, including the next one
  uint32_t pulse_ticks;
  struct hal_output step, direction_pin;
  int32_t end;  // position when the move is done
  struct move *oldest, *waiting, *newest;
} axes[HAL_STEPPERS];
static struct axis *soonest;  // next moving axis, in the order of their next steps
// A late step does not start before `low_until`, because drivers need the step pin low for a pulse
// length between two pulses.
static bool late;
static uint32_t low_until;

void stepgen_start(void) {
  for (struct axis *axis = axes; axis < axes + HAL_STEPPERS; ++axis) *axis = (struct axis){0};
  soonest = NULL;
  late = false;
}

bool stepgen_setup(uint8_t index, uint16_t step_pin, uint16_t direction_pin, bool invert,
                   uint16_t pulse_ticks) {
  if (index >= HAL_STEPPERS || pulse_ticks > LONGEST_PULSE) return false;
  struct axis *axis = &axes[index];
  *axis = (struct axis){.invert = invert, .pulse_ticks = pulse_ticks};
  if (!hal_output_setup(&axis->step, step_pin, invert)) return false;
  if (!hal_output_setup(&axis->direction_pin, direction_pin, false)) return false;
  return true;
}

// Starts the next move; under hal_irq_save() or in the interrupt.
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

// Calculates the step after the one at axis->next.
static void advance(struct axis *axis) {
  axis->next += axis->interval;
  axis->interval += (uint32_t)axis->add;
}

static void take_out(const struct axis *axis) {
  struct axis **at = &soonest;
  while (*at != axis) at = &(*at)->later;
  *at = axis->later;
}

// Inserts a moving axis in the order of its next step. The order is wrong for clocks at least 12 s
// apart; no host leaves that much between two steps.
static inline void insert(struct axis *axis) {
  struct axis **at = &soonest;
  while (*at != NULL && (int32_t)((*at)->next - axis->next) <= 0) at = &(*at)->later;
  axis->later = *at;
  *at = axis;
}

// Returns the clock of the next alarm.
static inline uint32_t alarm_at(void) {
  uint32_t next = soonest->next;
  return late && (int32_t)(next - low_until) < 0 ? low_until : next;
}

bool stepgen_interrupt(uint32_t now, uint32_t *again) {
  struct axis *due = NULL;
  uint32_t pulse_ticks = 0;
  for (struct axis *axis = soonest; axis != NULL && (int32_t)(axis->next - now) <= 0;) {
    hal_output_write(&axis->step, !axis->invert);
    if (axis->pulse_ticks > pulse_ticks) pulse_ticks = axis->pulse_ticks;
    axis->also = due;
    due = axis;
    soonest = axis = axis->later;
  }
  if (due != NULL) {
    uint32_t end = hal_clock() + pulse_ticks;
    int32_t low = INT32_MAX;  // ticks from the pulses to the next step of one of them
    // Calculates the next step during the pulses. Direction pins do not change until the pulses
    // end.
    for (struct axis *axis = due; axis != NULL; axis = axis->also) {
      if (--axis->count == 0) continue;
      advance(axis);
      insert(axis);
      if ((int32_t)(axis->next - end) < low) low = (int32_t)(axis->next - end);
    }
    stepgen_wait(end);
    for (struct axis *axis = due; axis != NULL; axis = axis->also) {
      hal_output_write(&axis->step, axis->invert);
      if (axis->count > 0) continue;
      load(axis);
      if (!axis->active) continue;
      advance(axis);
      insert(axis);
      if ((int32_t)(axis->next - end) < low) low = (int32_t)(axis->next - end);
    }
    // Reads the clock again only where needed, because that takes time.
    late = low < (int32_t)(2 * pulse_ticks);
    if (late) {
      low_until = hal_clock() + pulse_ticks;
      late = low < (int32_t)(low_until - end);
    }
  }
  if (soonest == NULL) return false;
  *again = alarm_at();
  return true;
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
      insert(axis);
      if (soonest == axis) stepgen_alarm(alarm_at());
    }
  }
  hal_irq_restore(irq);
  return taken;
}

bool stepgen_active(uint8_t index) { return axes[index].active; }

// Returns the remaining steps of the current move, with their sign.
static int32_t left(const struct axis *axis) {
  if (!axis->active) return 0;
  return axis->direction ? (int32_t)axis->count : -(int32_t)axis->count;
}

void stepgen_stop(uint8_t index) {
  struct axis *axis = &axes[index];
  hal_irq_t irq = hal_irq_save();
  axis->end -= left(axis);
  if (axis->active) take_out(axis);
  axis->active = false;
  axis->waiting = NULL;
  axis->stopped = true;
  if (soonest == NULL) late = false;
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
