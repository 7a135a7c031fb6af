#include "host.h"

#include <setjmp.h>
#include <stdlib.h>
#include <string.h>

#include "command.h"
#include "core.h"
#include "frame.h"
#include "hal.h"
#include "scheduler.h"
#include "shutdown.h"
#include "stepgen.h"

#define NEVER INT64_MAX
#define PINS 1024

DECL_CONSTANT("ADC_MAX", 1023);
DECL_CONSTANT("PWM_MAX", 255);
DECL_CONSTANT("RECEIVE_WINDOW", 192);
DECL_CONSTANT("MCU", "host");

uint32_t host_clock_hz;
uint16_t host_moves_max;
const uint8_t *host_dictionary;
uint16_t host_dictionary_size;

static struct host_surroundings around;
static int64_t now;
static int64_t not_before;  // clock of edges while a pulse is kept
static int64_t timer_due, steps_due;
static const uint8_t *fed, *fed_end;
static uint8_t *sent;
static size_t sent_size, sent_room;
static bool levels[PINS];
static jmp_buf power_on;

uint32_t hal_clock(void) { return (uint32_t)now; }

// Returns the 64-bit clock for a 32-bit one; the present clock if it is past.
static int64_t widen(uint32_t clock) {
  int32_t ahead = (int32_t)(clock - (uint32_t)now);
  return ahead > 0 ? now + ahead : now;
}
void hal_alarm(uint32_t clock) { timer_due = widen(clock); }
void stepgen_alarm(uint32_t clock) { steps_due = widen(clock); }
void stepgen_wait(uint32_t clock) { not_before = widen(clock); }

// The host has no interrupts.
hal_irq_t hal_irq_save(void) { return 0; }
void hal_irq_restore(hal_irq_t state) { (void)state; }

void hal_reset(void) { longjmp(power_on, 1); }

int16_t hal_console_read(void) { return fed == fed_end ? -1 : *fed++; }
uint8_t hal_console_room(void) { return UINT8_MAX; }
void hal_console_write(const uint8_t *data, uint8_t size) {
  if (sent_room - sent_size < size) {
    sent_room = 2 * sent_room + 256;
    sent = realloc(sent, sent_room);
    if (sent == NULL) abort();
  }
  memcpy(sent + sent_size, data, size);
  sent_size += size;
}

static void drive(uint16_t pin, bool level) {
  if (levels[pin] == level) return;
  levels[pin] = level;
  around.edge(around.owner, pin, level, now > not_before ? now : not_before);
}
bool hal_output_setup(struct hal_output *output, uint16_t pin, bool level) {
  if (pin >= PINS) return false;
  output->pin = pin;
  drive(pin, level);
  return true;
}
void hal_output_write(const struct hal_output *output, bool level) { drive(output->pin, level); }
bool hal_input_setup(struct hal_input *input, uint16_t pin, bool pull_up) {
  if (pin >= PINS) return false;
  input->pin = pin;
  if (pull_up) drive(pin, true);  // as far as the board is concerned
  return true;
}
bool hal_input_read(const struct hal_input *input) {
  return around.level(around.owner, input->pin, now);
}
bool hal_analog_setup(struct hal_analog *analog, uint16_t pin) {
  analog->pin = pin;
  return pin < PINS;
}
bool hal_analog_read(const struct hal_analog *analog, uint16_t *value) {
  *value = around.analog(around.owner, analog->pin, now);
  return true;
}
void hal_analog_cancel(const struct hal_analog *analog) { (void)analog; }
bool hal_pwm_setup(struct hal_pwm *pwm, uint16_t pin, uint32_t cycle, uint16_t value) {
  (void)cycle;
  (void)value;
  pwm->pin = pin;
  return pin < PINS;
}
// The clock stands still while the core works, so the bits are not edges of the pin.
bool hal_lights_send(const struct hal_output *output, const uint8_t *data, uint16_t size,
                     uint16_t bit_max) {
  (void)bit_max;
  return around.lights(around.owner, output->pin, data, size, now);
}
// host_watch_output() sees the chip's PWM on its pin.
void hal_pwm_write(const struct hal_pwm *pwm, uint16_t value) {
  (void)pwm;
  (void)value;
}
void host_watch_output(uint16_t pin, uint32_t value, uint32_t full) {
  around.output(around.owner, pin, value, full, now);
}

static void work(void) {
  while (core_task()) continue;
}

static void begin(void) {
  timer_due = steps_due = NEVER;
  not_before = now;
  stepgen_start();
  core_start((uint32_t)((uint64_t)now >> 32));
  work();
}

static void run(int64_t until) {
  for (;;) {
    int64_t due = timer_due < steps_due ? timer_due : steps_due;
    if (due > until) break;
    if (due > now) now = due;
    if (steps_due == due) {
      uint32_t again;
      steps_due = stepgen_interrupt(hal_clock(), &again) ? widen(again) : NEVER;
      not_before = now;
    } else {
      timer_due = NEVER;
      sched_interrupt();
      work();
    }
  }
  if (until > now) now = until;
}

static void start(const struct host_options *options,
                  const struct host_surroundings *surroundings) {
  host_clock_hz = options->clock_hz;
  host_moves_max = options->moves_max;
  host_dictionary = options->dictionary;
  host_dictionary_size = options->dictionary_size;
  around = *surroundings;
  now = options->start;
  fed = fed_end = NULL;
  sent_size = 0;
  memset(levels, 0, sizeof levels);
  begin();
}

static void feed(const uint8_t *data, size_t size, int64_t until) {
  run(until);
  fed = data;
  fed_end = data + size;
  if (setjmp(power_on) != 0) {
    fed = fed_end;
    begin();
  }
  work();
}

static int64_t next(void) { return timer_due; }

static const uint8_t *take(size_t *size) {
  *size = sent_size;
  sent_size = 0;
  return sent;
}

static struct host_state state(void) {
  return (struct host_state){shutdown_reason(), frame_counts.frames, frame_counts.naks};
}

static const uint8_t *built_dictionary(size_t *size) {
  *size = dictionary_size;
  return dictionary;
}

const struct host_functions *passo_firmware(void) {
  static const struct host_functions functions = {
      start, feed, run, next, take, state, built_dictionary,
  };
  return &functions;
}
