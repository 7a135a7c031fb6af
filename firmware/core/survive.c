#include "survive.h"

#include <stddef.h>

#include "analog_in.h"
#include "command.h"
#include "outputs.h"
#include "scheduler.h"
#include "shutdown.h"
#include "stepper.h"
#include "thermocouple.h"

DECL_SHUTDOWN(SURVIVE_TOO_LONG, "Output may not be held for so long");
DECL_SHUTDOWN(SURVIVE_UNWATCHED, "No sensor watches what an output is held for");
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

// Homing: switches stop the motors, and no commits come. Resting: the last commit ends with motors
// that stand. Moving: the next one must come in time. Lost: a step came too late while axes homed,
// and the motors were stopped, who knows where.
enum { OFF, HOMING, RESTING, MOVING, BRAKING, HELD, LOST };

// The decision falls so long before the commit's clock: time enough to queue all tails, or all
// moves of the commit that comes just in time.
#define GUARD (HAL_CLOCK_HZ / 200)
// So many seconds an output may be kept.
#define LONGEST 60

static bool decide(struct timer *timer);
static struct timer decision = {.run = decide};
// The timer writes them while the board is moving; then the foreground needs hal_irq_save() to.
static volatile uint8_t state;
static volatile bool undone;  // decided, and the tails not queued yet
static volatile bool untold;  // the host does not know of the decision
// The foreground's.
static uint32_t serial, limit;  // of the last commit
static bool missed;

void survive_start(void) {
  state = OFF;
  undone = untold = missed = false;
  serial = limit = 0;
}

bool survive_stages(void) { return state == RESTING || state == MOVING; }
bool survive_refuses(void) { return state >= BRAKING; }
bool survive_is_on(void) { return state != OFF; }

bool survive_watches(void) { return analog_in_watches() || thermocouple_watches(); }

uint32_t survive_in_time(uint32_t clock) {
  uint32_t now = hal_clock();
  return survive_is_on() && before(clock, now) ? now + HAL_SHORTEST_PERIOD : clock;
}

void survive_missed(void) { missed = true; }

bool survive_gives_up(void) {
  struct stepper *stepper;
  if (state != HOMING) return false;
  for (int16_t oid = -1; (stepper = object_next(&oid, OBJECT_STEPPER)) != NULL;)
    stepper_halt(stepper);
  state = LOST;
  untold = true;
  return true;
}

static bool decide(struct timer *timer) {
  (void)timer;
  if (state == MOVING && !is_shut_down()) {
    state = BRAKING;
    undone = untold = true;
    outputs_hold_none();
  }
  return false;
}

static void change(uint8_t to) {
  hal_irq_t irq = hal_irq_save();
  timer_remove(&decision);
  state = to;
  undone = untold = missed = false;
  hal_irq_restore(irq);
}

static bool any_active(void) {
  struct stepper *stepper;
  for (int16_t oid = -1; (stepper = object_next(&oid, OBJECT_STEPPER)) != NULL;)
    if (stepgen_active(stepper->axis)) return true;
  return false;
}

static bool report_state(void) {
  if (state == BRAKING && !undone && !any_active()) state = HELD;
  uint8_t told = state == RESTING && any_active() ? MOVING : state;
  return report(REPORT_SURVIVE_STATE, (uint32_t[]){told, serial, limit}, 3);
}

// Of each motor in turn: the most urgent moves are the first ones.
static void give_staged(void) {
  struct stepper *stepper;
  for (bool more = true; more;) {
    more = false;
    for (int16_t oid = -1; (stepper = object_next(&oid, OBJECT_STEPPER)) != NULL;)
      more |= stepper_give_staged(stepper);
  }
}

void survive_task(void) {
  struct stepper *stepper;
  if (state == OFF) return;
  if (is_shut_down()) {
    change(OFF);
    for (int16_t oid = -1; (stepper = object_next(&oid, OBJECT_STEPPER)) != NULL;)
      stepper_forget(stepper, true);
  } else if (undone) {
    undone = false;
    for (int16_t oid = -1; (stepper = object_next(&oid, OBJECT_STEPPER)) != NULL;)
      stepper_stage_tail(stepper);
    give_staged();
  }
  // A host that was only late must hear of it.
  if (untold) untold = !report_state();
}

// The host takes over, from motors that stand: what was staged is void.
static void begin(uint8_t to) {
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
  if (state == OFF) serial = 0;
  begin(RESTING);
}

DECL_COMMAND(command_survive_home, "survive_home", 0);
void command_survive_home(const uint32_t *args) {
  (void)args;
  serial = 0;
  begin(HOMING);
}

DECL_COMMAND(command_survive_off, "survive_off", 0);
void command_survive_off(const uint32_t *args) {
  (void)args;
  begin(OFF);
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
  // Where it rests no decision has told that time is up.
  if (survive_stages() && (missed || (late && state == RESTING))) {
    state = MOVING;
    decide(&decision);
  }
  bool valid = survive_stages() && !is_shut_down();
  if (valid) {
    timer_remove(&decision);
    state = args[2] != 0 ? RESTING : MOVING;
    serial = args[0];
    limit = args[1];
    decision.wake = limit - GUARD;
    if (args[2] != 0)
      ;  // nothing to decide
    else if (before(decision.wake, hal_clock() + HAL_SHORTEST_PERIOD))
      decide(&decision);  // it is nearly over already
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
  // Before the acknowledgement, so that a host that has that knows.
  if (state >= BRAKING) untold = !report_state();
}

DECL_COMMAND(command_survive_output, "survive_output oid=%c value=%u seconds=%c", 0);
void command_survive_output(const uint32_t *args) {
  struct output *output = object_find(args[0], OBJECT_PWM_OUT);
  if (output == NULL) output = object_get(args[0], OBJECT_DIGITAL_OUT);
  if (output == NULL) return;
  if (args[2] > LONGEST)
    shut_down(SHUTDOWN_SURVIVE_TOO_LONG);
  else if (args[2] > 0 && args[1] != output->default_value && !survive_watches())
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
