#include "outputs.h"

#include <stddef.h>

#include "command.h"
#include "hooks.h"
#include "shutdown.h"
#include "survive_state.h"

DECL_SHUTDOWN_REASON(MISSED_DIGITAL, "Missed scheduling of next digital out event");
DECL_SHUTDOWN_REASON(MISSED_PWM, "Missed scheduling of next hard pwm event");
DECL_SHUTDOWN_REASON(OUTPUT_BUSY, "Output updated while its queue holds commands");
DECL_SHUTDOWN_REASON(OUTPUT_PIN, "Not a valid output pin");
DECL_SHUTDOWN_REASON(PWM_PIN, "Not a valid PWM pin");
DECL_SHUTDOWN_REASON(DURATION_TOO_LONG, "Duration too long for the clock");
DECL_SHUTDOWN_REASON(NOT_AT_DEFAULT, "Output with a maximum duration must begin at its default");
DECL_SHUTDOWN_REASON(PIN_CONFIGURED, "Pin belongs to a configured output");

#ifndef HAL_WATCH_OUTPUT
#define HAL_WATCH_OUTPUT(pin, value, full) ((void)0)
#endif

static void write_level(struct output *output, bool level) {
  output->level = level;
  hal_output_write(&output->digital, level);
}

// Sets the output to `value` at `clock`, which is now or shortly past.
static void set(struct output *output, uint32_t clock, uint32_t value) {
  output->value = value;
  output->watched = output->max_duration != 0 && value != output->default_value;
  output->expires = clock + output->max_duration;
  output->keeping = false;
  HAL_WATCH_OUTPUT(output->pin, value, output->full);
  if (output->object.kind->type == OBJECT_PWM_OUT) {
    hal_pwm_write(&output->pwm, (uint16_t)value);
    return;
  }
  output->toggling = value != 0 && value != output->full;
  output->toggle = clock + value;
  output->rest = output->full - value;
  write_level(output, value != 0);
}

// Writes the clock of the next event to timer->wake; returns false if no event follows.
static bool plan(struct output *output) {
  bool any = false;
  uint32_t wake = 0;
  if (output->first != NULL) wake = output->first->clock, any = true;
  if (output->watched && (!any || before(output->expires, wake)))
    wake = output->expires, any = true;
  if (output->toggling && (!any || before(output->toggle, wake))) wake = output->toggle, any = true;
  output->timer.wake = wake;
  output->waiting = any;
  return any;
}

static uint32_t from_default(const struct output *output, uint32_t value) {
  return value > output->default_value ? value - output->default_value
                                       : output->default_value - value;
}

// The maximum duration of an output has passed without its host. Returns false if the board must
// shut down.
static bool keep(struct output *output, uint32_t clock) {
  if (!output->kept || !survive_is_on()) return false;
  if (!output->keeping) output->left = output->kept_seconds;
  uint32_t value = output->value < output->full ? output->value : output->full;
  if (from_default(output, output->kept_value) < from_default(output, value))
    value = output->kept_value;
  if (output->left == 0 || !hooks_watch()) value = output->default_value;
  set(output, clock, value);
  output->keeping = true;
  if (output->left > 0) --output->left;
  output->expires = clock + HAL_CLOCK_HZ;
  return true;
}

static bool run(struct timer *timer) {
  struct output *output = (struct output *)((char *)timer - offsetof(struct output, timer));
  uint32_t clock = timer->wake;
  struct change *change;
  while ((change = output->first) != NULL && !before(clock, change->clock)) {
    output->first = change->next;
    set(output, change->clock, change->value);
    move_free((struct move *)(void *)change);
  }
  if (output->watched && !before(clock, output->expires) && !keep(output, clock)) {
    shut_down(output->object.kind->type == OBJECT_PWM_OUT ? SHUTDOWN_MISSED_PWM
                                                          : SHUTDOWN_MISSED_DIGITAL);
    return false;
  }
  if (output->toggling && !before(clock, output->toggle)) {
    write_level(output, !output->level);
    output->toggle += output->level ? output->value : output->rest;
  }
  return plan(output);
}

static void drop_changes(struct output *output) {
  while (output->first != NULL) {
    struct change *change = output->first;
    output->first = change->next;
    move_free((struct move *)(void *)change);
  }
}

static void restart(struct output *output) {
  timer_remove(&output->timer);
  if (plan(output)) timer_add(&output->timer);
}

void output_keep(struct output *output, uint32_t value, uint8_t seconds) {
  hal_irq_t irq = hal_irq_save();
  output->kept_value = value < output->full ? value : output->full;
  output->kept_seconds = seconds;
  output->kept = true;
  hal_irq_restore(irq);
}

void outputs_hold_none(void) {
  static const uint8_t types[] = {OBJECT_DIGITAL_OUT, OBJECT_PWM_OUT};
  for (uint8_t i = 0; i < sizeof types; ++i) {
    struct output *output;
    for (int16_t oid = -1; (output = object_next(&oid, types[i])) != NULL;) {
      if (!output->kept || output->kept_seconds > 0) continue;
      drop_changes(output);
      set(output, hal_clock(), output->default_value);
      restart(output);
    }
  }
}

static void shut_down_output(void *object) {
  struct output *output = object;
  timer_remove(&output->timer);
  drop_changes(output);
  set(output, 0, output->default_value);
  output->watched = output->waiting = false;
}

static const struct object_kind digital_kind = {OBJECT_DIGITAL_OUT, shut_down_output};
static const struct object_kind pwm_kind = {OBJECT_PWM_OUT, shut_down_output};

static bool is_configured(uint32_t pin) {
  static const uint8_t types[] = {OBJECT_DIGITAL_OUT, OBJECT_PWM_OUT};
  for (uint8_t i = 0; i < sizeof types; ++i) {
    const struct output *output;
    for (int16_t oid = -1; (output = object_next(&oid, types[i])) != NULL;)
      if (output->pin == pin) return true;
  }
  return false;
}

// Creates an output whose pin is set up, in a state in which no timer runs. Shuts down and returns
// false if the caller must set the pin to its default, because there is no output.
static bool configure(uint32_t oid, const struct object_kind *kind, const struct output *wanted) {
  if ((int32_t)wanted->max_duration < 0) {
    shut_down(SHUTDOWN_DURATION_TOO_LONG);
    return is_configured(wanted->pin);
  }
  // No timer counts the duration from here on.
  if (wanted->max_duration != 0 && wanted->value != wanted->default_value) {
    shut_down(SHUTDOWN_NOT_AT_DEFAULT);
    return is_configured(wanted->pin);
  }
  hal_irq_t irq = hal_irq_save();
  struct output *output = object_add(oid, kind, sizeof *output);
  if (output != NULL) {
    *output = *wanted;
    output->object.kind = kind;
    output->timer.run = run;
    HAL_WATCH_OUTPUT(output->pin, output->value, output->full);
    if (is_shut_down()) shut_down_output(output);
  }
  hal_irq_restore(irq);
  return output != NULL || is_configured(wanted->pin);
}

DECL_COMMAND(command_config_digital_out,
             "config_digital_out oid=%c pin=%u value=%c default_value=%c max_duration=%u", 0);
void command_config_digital_out(const uint32_t *args) {
  struct output wanted = {.pin = (uint16_t)args[1],
                          .full = 1,
                          .value = args[2] != 0,
                          .default_value = args[3] != 0,
                          .max_duration = args[4]};
  if (is_configured(args[1]))
    shut_down(SHUTDOWN_PIN_CONFIGURED);
  else if (args[1] > 0xffff || !hal_output_setup(&wanted.digital, wanted.pin, args[2] != 0))
    shut_down(SHUTDOWN_OUTPUT_PIN);
  else if (!configure(args[0], &digital_kind, &wanted))
    hal_output_write(&wanted.digital, wanted.default_value != 0);
}

DECL_COMMAND(command_config_pwm_out,
             "config_pwm_out oid=%c pin=%u cycle_ticks=%u value=%hu default_value=%hu"
             " max_duration=%u",
             0);
void command_config_pwm_out(const uint32_t *args) {
  struct output wanted = {.pin = (uint16_t)args[1],
                          .full = HAL_PWM_MAX,
                          .value = args[3] < HAL_PWM_MAX ? args[3] : HAL_PWM_MAX,
                          .default_value = args[4] < HAL_PWM_MAX ? args[4] : HAL_PWM_MAX,
                          .max_duration = args[5]};
  if (is_configured(args[1]))
    shut_down(SHUTDOWN_PIN_CONFIGURED);
  else if (args[1] > 0xffff ||
           !hal_pwm_setup(&wanted.pwm, wanted.pin, args[2], (uint16_t)wanted.value))
    shut_down(SHUTDOWN_PWM_PIN);
  else if (!configure(args[0], &pwm_kind, &wanted))
    hal_pwm_write(&wanted.pwm, (uint16_t)wanted.default_value);
}

// While the board runs without its host, commands turn on only outputs that are kept.
static bool is_barred(const struct output *output) {
  return survive_refuses() && output->kept && output->kept_seconds == 0;
}

// A board that survives a link loss also survives a bad link: late values act at once (a light goes
// off), and the board brakes.
static void queue(struct output *output, uint32_t clock, uint32_t value) {
  struct change *change = (struct change *)(void *)move_take();
  if (change == NULL) return;
  // No interrupt may come between reading the clock and starting the timer.
  hal_irq_t irq = hal_irq_save();
  bool late = before(clock, hal_clock()), heats = output->kept && output->kept_seconds > 0;
  if (late && output->kept && !heats) {
    value = output->default_value;
    survive_miss();
  }
  clock = survive_in_time(clock);
  change->next = NULL;
  change->clock = clock;
  change->value = value < output->full ? value : output->full;
  // The host sends again the changes that it had planned after the decision.
  if (is_shut_down() || is_barred(output) || (late && survive_refuses() && !heats)) {
    move_free((struct move *)(void *)change);
  } else if (before(clock, hal_clock())) {
    move_free((struct move *)(void *)change);
    shut_down(SHUTDOWN_TIMER_TOO_CLOSE);
  } else {
    if (output->first == NULL)
      output->first = change;
    else
      output->last->next = change;
    output->last = change;
    if (!output->waiting || before(clock, output->timer.wake)) {
      timer_remove(&output->timer);
      output->timer.wake = clock;
      output->waiting = true;
      timer_add(&output->timer);
    }
  }
  hal_irq_restore(irq);
}

DECL_COMMAND(command_queue_digital_out, "queue_digital_out oid=%c clock=%u on_ticks=%u", 0);
void command_queue_digital_out(const uint32_t *args) {
  struct output *output = object_get(args[0], OBJECT_DIGITAL_OUT);
  if (output != NULL) queue(output, args[1], args[2]);
}

DECL_COMMAND(command_queue_pwm_out, "queue_pwm_out oid=%c clock=%u value=%hu", 0);
void command_queue_pwm_out(const uint32_t *args) {
  struct output *output = object_get(args[0], OBJECT_PWM_OUT);
  if (output != NULL) queue(output, args[1], args[2]);
}

DECL_COMMAND(command_update_digital_out, "update_digital_out oid=%c value=%c", 0);
void command_update_digital_out(const uint32_t *args) {
  struct output *output = object_get(args[0], OBJECT_DIGITAL_OUT);
  if (output == NULL || !check_finalized()) return;
  hal_irq_t irq = hal_irq_save();
  if (output->first != NULL) {
    shut_down(SHUTDOWN_OUTPUT_BUSY);
  } else if (!is_shut_down() && !is_barred(output)) {
    timer_remove(&output->timer);
    set(output, hal_clock(), args[1] != 0 ? output->full : 0);
    if (plan(output)) timer_add(&output->timer);
  }
  hal_irq_restore(irq);
}

// The current cycle continues until the next value.
DECL_COMMAND(command_set_digital_out_pwm_cycle, "set_digital_out_pwm_cycle oid=%c cycle_ticks=%u",
             0);
void command_set_digital_out_pwm_cycle(const uint32_t *args) {
  struct output *output = object_get(args[0], OBJECT_DIGITAL_OUT);
  if (output == NULL) return;
  hal_irq_t irq = hal_irq_save();
  if ((int32_t)args[1] < 0) {
    shut_down(SHUTDOWN_DURATION_TOO_LONG);
  } else if (output->first != NULL) {
    shut_down(SHUTDOWN_OUTPUT_BUSY);
  } else {
    uint32_t cycle = args[1] > 0 ? args[1] : 1;
    if (!output->toggling)
      output->value = output->value != 0 ? cycle : 0;
    else
      output->kept_seconds = 0;  // the value belongs to an earlier cycle
    output->default_value = output->default_value != 0 ? cycle : 0;
    output->full = cycle;
  }
  hal_irq_restore(irq);
}

DECL_COMMAND(command_set_digital_out, "set_digital_out pin=%u value=%c", 0);
void command_set_digital_out(const uint32_t *args) {
  struct hal_output output;
  if (is_configured(args[0]))
    shut_down(SHUTDOWN_PIN_CONFIGURED);
  else if (args[0] > 0xffff || !hal_output_setup(&output, (uint16_t)args[0], args[1] != 0))
    shut_down(SHUTDOWN_OUTPUT_PIN);
  else
    HAL_WATCH_OUTPUT((uint16_t)args[0], args[1] != 0, 1);
}

DECL_COMMAND(command_set_pwm_out, "set_pwm_out pin=%u cycle_ticks=%u value=%hu", 0);
void command_set_pwm_out(const uint32_t *args) {
  struct hal_pwm pwm;
  uint16_t value = args[2] < HAL_PWM_MAX ? (uint16_t)args[2] : HAL_PWM_MAX;
  if (is_configured(args[0]))
    shut_down(SHUTDOWN_PIN_CONFIGURED);
  else if (args[0] > 0xffff || !hal_pwm_setup(&pwm, (uint16_t)args[0], args[1], value))
    shut_down(SHUTDOWN_PWM_PIN);
  else
    HAL_WATCH_OUTPUT((uint16_t)args[0], value, HAL_PWM_MAX);
}
