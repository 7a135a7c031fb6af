// Survive (survive_state.h): the host's commands, and the decision to brake.
#include <stddef.h>

#include "command.h"
#include "hooks.h"
#include "object.h"
#include "outputs.h"
#include "scheduler.h"
#include "shutdown.h"
#include "stepper.h"
#include "survive_state.h"

DECL_SHUTDOWN_REASON(SURVIVE_TOO_LONG, "Output may not be held for so long");
DECL_SHUTDOWN_REASON(SURVIVE_UNWATCHED, "No sensor watches what an output is held for");
DECL_REPORT("survive_state state=%c serial=%u clock=%u");
DECL_CONSTANT("SURVIVE", 2);
DECL_CONSTANT("SURVIVE_GUARD_MS", 5);
DECL_CONSTANT("SURVIVE_OUTPUT_S", 60);
DECL_ENUMERATION("survive", "off", 0);
DECL_ENUMERATION("survive", "homing", 1);
DECL_ENUMERATION("survive", "resting", 2);
DECL_ENUMERATION("survive", "moving", 3);
DECL_ENUMERATION("survive", "braking", 4);
DECL_ENUMERATION("survive", "held", 5);
DECL_ENUMERATION("survive", "lost", 6);

// The board decides this long before the clock of the last commit. The time must be enough to queue
// all tails, or all moves of a commit that arrives just in time.
#define GUARD (HAL_CLOCK_HZ / 200)
// Maximum time, s, for which an output may be kept without the host.
#define LONGEST 60

static bool decide(struct timer *timer);
static struct timer decision = {.run = decide};
// The board has decided to brake, but has not queued the tails yet. Written by the same contexts as
// survive.state.
static volatile bool tails_pending;
// Serial number and clock of the last commit. Written by the foreground.
static uint32_t serial, limit;

DECL_START(survive_commits_start);
void survive_commits_start(void) {
  tails_pending = false;
  serial = limit = 0;
}

static bool decide(struct timer *timer) {
  (void)timer;
  if (survive.state == SURVIVE_MOVING && !is_shut_down()) {
    survive.state = SURVIVE_BRAKING;
    tails_pending = survive.report_pending = true;
    outputs_hold_none();
  }
  return false;
}

static void change(uint8_t to) {
  hal_irq_t irq = hal_irq_save();
  timer_remove(&decision);
  survive.state = to;
  tails_pending = survive.report_pending = survive.missed = false;
  hal_irq_restore(irq);
}

static bool any_active(void) {
  struct stepper *stepper;
  for (int16_t oid = -1; (stepper = object_next(&oid, OBJECT_STEPPER)) != NULL;)
    if (stepgen_active(stepper->axis)) return true;
  return false;
}

static bool report_state(void) {
  if (survive.state == SURVIVE_BRAKING && !tails_pending && !any_active())
    survive.state = SURVIVE_HELD;
  uint8_t state = survive.state;
  if (state == SURVIVE_RESTING && any_active()) state = SURVIVE_MOVING;
  return report(REPORT_SURVIVE_STATE, (uint32_t[]){state, serial, limit}, 3);
}

// Passes one move of each motor in turn to the generator, so that the most urgent moves come first.
static void give_staged(void) {
  struct stepper *stepper;
  for (bool more = true; more;) {
    more = false;
    for (int16_t oid = -1; (stepper = object_next(&oid, OBJECT_STEPPER)) != NULL;)
      more |= stepper_give_staged(stepper);
  }
}

// After a decision, queues the tails, before another task can delay that. After a shutdown, drops
// all moves.
DECL_TASK(survive_task, EVERY_PASS);
DECL_ON_CLEAR_SHUTDOWN(survive_task);
void survive_task(void) {
  struct stepper *stepper;
  if (survive.state == SURVIVE_OFF) return;
  if (is_shut_down()) {
    change(SURVIVE_OFF);
    for (int16_t oid = -1; (stepper = object_next(&oid, OBJECT_STEPPER)) != NULL;)
      stepper_forget(stepper, true);
  } else if (tails_pending) {
    tails_pending = false;
    for (int16_t oid = -1; (stepper = object_next(&oid, OBJECT_STEPPER)) != NULL;)
      stepper_stage_tail(stepper);
    give_staged();
  }
  // The host may be connected, but late: then it needs the report.
  if (survive.report_pending) survive.report_pending = !report_state();
}

// Enters a state at standstill, on command of the host. Staged moves are dropped.
static void enter(uint8_t to) {
  struct stepper *stepper;
  if (!check_finalized()) return;
  survive_task();
  change(to);
  for (int16_t oid = -1; (stepper = object_next(&oid, OBJECT_STEPPER)) != NULL;)
    stepper_forget(stepper, true);
}

DECL_COMMAND(command_survive_arm, "survive_arm", 0);
void command_survive_arm(const uint32_t *args) {
  (void)args;
  if (survive.state == SURVIVE_OFF) serial = 0;
  enter(SURVIVE_RESTING);
}

DECL_COMMAND(command_survive_home, "survive_home", 0);
void command_survive_home(const uint32_t *args) {
  (void)args;
  serial = 0;
  enter(SURVIVE_HOMING);
}

DECL_COMMAND(command_survive_off, "survive_off", 0);
void command_survive_off(const uint32_t *args) {
  (void)args;
  enter(SURVIVE_OFF);
}

DECL_COMMAND(command_survive_tail, "survive_tail oid=%c interval=%u count=%hu add=%hi dir=%c", 0);
void command_survive_tail(const uint32_t *args) {
  struct stepper *stepper = object_get(args[0], OBJECT_STEPPER);
  if (stepper != NULL && survive_stages()) stepper_add_tail(stepper, args);
}

DECL_COMMAND(command_survive_commit, "survive_commit serial=%u clock=%u rest=%c", 0);
void command_survive_commit(const uint32_t *args) {
  struct stepper *stepper;
  bool late = false;
  for (int16_t oid = -1; (stepper = object_next(&oid, OBJECT_STEPPER)) != NULL;)
    late |= stepper_is_late(stepper);
  hal_irq_t irq = hal_irq_save();
  // The timer of the decision does not run at rest, so lateness is detected here.
  if (survive_stages() && (survive.missed || (late && survive.state == SURVIVE_RESTING))) {
    survive.state = SURVIVE_MOVING;
    decide(&decision);
  }
  bool valid = survive_stages() && !is_shut_down();
  if (valid) {
    timer_remove(&decision);
    survive.state = args[2] != 0 ? SURVIVE_RESTING : SURVIVE_MOVING;
    serial = args[0];
    limit = args[1];
    decision.wake = limit - GUARD;
    if (args[2] != 0)
      ;  // no decision: the motors stop after this commit
    else if (before(decision.wake, hal_clock() + HAL_SHORTEST_PERIOD))
      decide(&decision);  // the time for the decision has passed
    else
      timer_add(&decision);
  }
  hal_irq_restore(irq);
  if (valid) {
    give_staged();
    for (int16_t oid = -1; (stepper = object_next(&oid, OBJECT_STEPPER)) != NULL;)
      stepper_take_tail(stepper);
    return;
  }
  for (int16_t oid = -1; (stepper = object_next(&oid, OBJECT_STEPPER)) != NULL;)
    stepper_forget(stepper, false);
  // Sent before the acknowledgement of the commit: a host with the acknowledgement has the report.
  if (survive.state >= SURVIVE_BRAKING) survive.report_pending = !report_state();
}

DECL_COMMAND(command_survive_output, "survive_output oid=%c value=%u seconds=%c", 0);
void command_survive_output(const uint32_t *args) {
  struct output *output = object_find(args[0], OBJECT_PWM_OUT);
  if (output == NULL) output = object_get(args[0], OBJECT_DIGITAL_OUT);
  if (output == NULL) return;
  if (args[2] > LONGEST)
    shut_down(SHUTDOWN_SURVIVE_TOO_LONG);
  else if (args[2] > 0 && args[1] != output->default_value && !hooks_watch())
    shut_down(SHUTDOWN_SURVIVE_UNWATCHED);
  else
    output_keep(output, args[1], (uint8_t)args[2]);
}

DECL_COMMAND(command_survive_query, "survive_query", IN_SHUTDOWN);
void command_survive_query(const uint32_t *args) {
  (void)args;
  survive_task();
  report_state();
}
