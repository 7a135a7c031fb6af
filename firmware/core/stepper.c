#include "stepper.h"

#include <stddef.h>

#include "command.h"
#include "scheduler.h"
#include "shutdown.h"
#include "survive_state.h"

DECL_SHUTDOWN_REASON(STEP_TOO_LATE, "Stepper too far in past");
DECL_SHUTDOWN_REASON(COUNT_ZERO, "Invalid count parameter");
DECL_SHUTDOWN_REASON(STEPPER_ACTIVE, "Can't reset time when stepper active");
DECL_SHUTDOWN_REASON(STEPPER_PINS, "Image cannot drive a stepper with these pins and pulses");
DECL_REPORT("stepper_position oid=%c pos=%i");

// A first step that is later than this means a wrong clock, not a message that was a little late.
#define LATE (HAL_CLOCK_HZ / 1000)

static uint8_t axes;

static void shut_down_stepper(void *object) { stepper_halt(object); }
static const struct object_kind kind = {OBJECT_STEPPER, shut_down_stepper};

DECL_START(steppers_start);
void steppers_start(void) { axes = 0; }

void stepper_halt(struct stepper *stepper) {
  hal_irq_t irq = hal_irq_save();
  stepper->halted = true;
  stepgen_stop(stepper->axis);
  hal_irq_restore(irq);
}

// Returns moves that the generator has completed to the pool.
DECL_ON_POOL_EMPTY(steppers_reclaim);
void steppers_reclaim(void) {
  for (uint8_t axis = 0; axis < axes; ++axis) {
    struct move *move;
    while ((move = stepgen_reclaim(axis)) != NULL) move_free(move);
  }
}

DECL_COMMAND(command_config_stepper,
             "config_stepper oid=%c step_pin=%u dir_pin=%u invert_step=%c step_pulse_ticks=%u", 0);
void command_config_stepper(const uint32_t *args) {
  if (args[4] > 0xffff ||
      !stepgen_setup(axes, (uint16_t)args[1], (uint16_t)args[2], args[3] != 0, (uint16_t)args[4])) {
    shut_down(SHUTDOWN_STEPPER_PINS);
    return;
  }
  struct stepper *stepper = object_add(args[0], &kind, sizeof *stepper);
  if (stepper != NULL) stepper->axis = axes++;
}

// Takes a move from the pool and fills it from a command (args[1] to args[3]). Returns null after a
// shutdown.
static struct move *move_of(const uint32_t *args, uint8_t direction) {
  uint32_t interval = args[1];
  uint16_t count = (uint16_t)args[2];
  int16_t add = (int16_t)args[3];
  struct move *move = move_take();
  if (move == NULL) return NULL;
  // The last interval must not be negative, and must not look negative in a 32-bit clock.
  uint32_t change = (uint32_t)(add < 0 ? -(int32_t)add : add) * (uint16_t)(count - 1);
  if (count > 0 && ((int32_t)interval < 0 || (count > 1 && interval == 0) ||
                    (add < 0 ? change > interval : (int32_t)(interval + change) < 0))) {
    move_free(move);
    shut_down(SHUTDOWN_STEP_TOO_LATE);
    return NULL;
  }
  move->next = NULL;
  move->interval = interval;
  move->count = count;
  move->add = add;
  move->direction = direction;
  return move;
}

// Sets the clock of the last step, and accepts steps again.
static void set_clock(struct stepper *stepper, uint32_t clock) {
  hal_irq_t irq = hal_irq_save();
  if (stepgen_active(stepper->axis)) {
    shut_down(SHUTDOWN_STEPPER_ACTIVE);
  } else if (!is_shut_down()) {
    stepper->last = clock;
    stepper->halted = false;
    stepgen_resume(stepper->axis);
  }
  hal_irq_restore(irq);
}

// Handles a step that came too late. During homing with survive, stops all motors, informs the host
// and returns true. Otherwise returns false: the board must shut down.
static bool stop_homing(void) {
  struct stepper *stepper;
  if (!survive_is_homing()) return false;
  for (int16_t oid = -1; (stepper = object_next(&oid, OBJECT_STEPPER)) != NULL;)
    stepper_halt(stepper);
  survive_lose();
  return true;
}

// Passes a move to the generator. A move without steps sets the clock instead.
static void give(struct stepper *stepper, struct move *move) {
  uint32_t interval = move->interval;
  if (move->count == 0) {
    move_free(move);
    set_clock(stepper, interval);
    return;
  }
  uint16_t count = move->count;
  int16_t add = move->add;
  if (stepper->halted) {
    move_free(move);
    return;
  }
  uint32_t first_step = stepper->last + interval;
  if (!stepgen_append(stepper->axis, move, first_step)) {
    move_free(move);
    if (stepper->halted || stop_homing()) return;  // halted: by a shutdown just now
    shut_down((int32_t)(hal_clock() - first_step) > (int32_t)LATE ? SHUTDOWN_STEP_TOO_LATE
                                                                  : SHUTDOWN_TIMER_TOO_CLOSE);
    return;
  }
  uint32_t pairs = (uint32_t)count * (uint16_t)(count - 1) / 2;
  stepper->last += interval * count + (uint32_t)(int32_t)add * pairs;
}

static void put(struct move_list *list, struct move *move) {
  if (list->first == NULL)
    list->first = move;
  else
    list->last->next = move;
  list->last = move;
}

static struct move *take(struct move_list *list) {
  struct move *move = list->first;
  if (move != NULL) list->first = move->next;
  return move;
}

static void drop(struct move_list *list) {
  struct move *move;
  while ((move = take(list)) != NULL) move_free(move);
}

DECL_COMMAND(command_queue_step, "queue_step oid=%c interval=%u count=%hu add=%hi", 0);
void command_queue_step(const uint32_t *args) {
  struct stepper *stepper = object_get(args[0], OBJECT_STEPPER);
  if (stepper == NULL) return;
  if ((uint16_t)args[2] == 0) {
    shut_down(SHUTDOWN_COUNT_ZERO);
    return;
  }
  struct move *move = move_of(args, stepper->direction);
  if (move == NULL) return;
  if (survive_refuses())
    move_free(move);
  else if (survive_stages())
    put(&stepper->staged, move);
  else
    give(stepper, move);
}

void stepper_add_tail(struct stepper *stepper, const uint32_t *args) {
  struct move *move = move_of(args, args[4] != 0);
  if (move != NULL) put(&stepper->next_tail, move);
}

bool stepper_is_late(const struct stepper *stepper) {
  uint32_t clock = stepper->last;
  bool halted = stepper->halted;
  if (stepgen_active(stepper->axis)) return false;
  const struct move *first[] = {stepper->staged.first, stepper->next_tail.first};
  for (uint8_t i = 0; i < 2; ++i)
    for (const struct move *move = first[i]; move != NULL; move = move->next) {
      if (move->count > 0)
        return !halted && before(clock + move->interval, hal_clock() + HAL_COMMIT_WORK);
      clock = move->interval;
      halted = false;
    }
  return false;
}

bool stepper_give_staged(struct stepper *stepper) {
  struct move *move;
  bool steps = false;
  while (!steps && (move = take(&stepper->staged)) != NULL) {
    steps = move->count > 0;
    give(stepper, move);
  }
  return steps;
}

void stepper_take_tail(struct stepper *stepper) {
  drop(&stepper->tail);
  stepper->tail = stepper->next_tail;
  stepper->next_tail.first = NULL;
}

void stepper_stage_tail(struct stepper *stepper) {
  drop(&stepper->staged);
  drop(&stepper->next_tail);
  stepper->staged = stepper->tail;
  stepper->tail.first = NULL;
}

void stepper_forget(struct stepper *stepper, bool tail) {
  struct move *move;
  while ((move = take(&stepper->staged)) != NULL) {
    if (tail && move->count == 0 && !stepgen_active(stepper->axis))
      give(stepper, move);
    else
      move_free(move);
  }
  drop(&stepper->next_tail);
  if (tail) drop(&stepper->tail);
}

DECL_COMMAND(command_set_next_step_dir, "set_next_step_dir oid=%c dir=%c", 0);
void command_set_next_step_dir(const uint32_t *args) {
  struct stepper *stepper = object_get(args[0], OBJECT_STEPPER);
  if (stepper != NULL && check_finalized()) stepper->direction = args[1] != 0;
}

DECL_COMMAND(command_reset_step_clock, "reset_step_clock oid=%c clock=%u", 0);
void command_reset_step_clock(const uint32_t *args) {
  struct stepper *stepper = object_get(args[0], OBJECT_STEPPER);
  if (stepper == NULL || !check_finalized() || survive_refuses()) return;
  if (!survive_stages()) {
    set_clock(stepper, args[1]);
    return;
  }
  struct move *move = move_of((const uint32_t[]){args[0], args[1], 0, 0}, 0);
  if (move != NULL) put(&stepper->staged, move);
}

DECL_COMMAND(command_stepper_get_position, "stepper_get_position oid=%c", 0);
void command_stepper_get_position(const uint32_t *args) {
  struct stepper *stepper = object_get(args[0], OBJECT_STEPPER);
  if (stepper == NULL) return;
  uint32_t position = (uint32_t)stepgen_position(stepper->axis);
  report(REPORT_STEPPER_POSITION, (uint32_t[]){args[0], position}, 2);
}
