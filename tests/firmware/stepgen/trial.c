// Drives the step generator of chips with one alarm at random: moves come, motors are stopped and
// take moves again, interrupts are late. Each step must come in its order and direction, never
// early, its pulse and the low time before it as long as the driver asks; and the position must
// count the steps that were made. Usage: trial SEED
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal.h"
#include "stepgen.h"

#define ROUNDS 40
#define OPERATIONS 3000
#define WAITING 4096  // steps of a motor, at most
#define MOVES 600

static uint64_t now, alarm_clock;
static bool alarm_set, in_interrupt;

static struct motor {
  bool step, direction;  // levels
  uint32_t pulse_ticks;
  uint64_t rose, fell;
  int32_t position;
  struct {
    uint64_t clock;
    uint8_t direction;
  } due[WAITING];
  uint32_t made, told;  // indices of due, modulo WAITING
  uint64_t end;         // clock of the last step told
  uint8_t next_direction;
  bool stopped;
  struct move moves[MOVES];
  uint32_t given, held;
} motors[HAL_STEPPERS];
static uint64_t latest;

static uint32_t random_below(uint32_t limit) { return (uint32_t)((uint64_t)rand() * limit >> 31); }

static void check(bool good, const char* what) {
  if (good) return;
  puts(what);
  exit(1);
}

uint32_t hal_clock(void) {
  now += random_below(4);
  return (uint32_t)now;
}
hal_irq_t hal_irq_save(void) { return 0; }
void hal_irq_restore(hal_irq_t state) { (void)state; }

static uint64_t widened(uint32_t clock) { return now + (uint64_t)(int32_t)(clock - (uint32_t)now); }

void stepgen_alarm(uint32_t clock) {
  check(!in_interrupt, "an alarm is set in the interrupt");
  alarm_clock = widened(clock);
  alarm_set = true;
}

void stepgen_wait(uint32_t clock) {
  while ((int32_t)((uint32_t)now - clock) <= 0) ++now;
  now += random_below(5);
}

// Motor i has the pins 2i (steps) and 2i + 1 (direction).
bool hal_output_setup(struct hal_output* output, uint16_t pin, bool level) {
  (void)level;
  output->pin = pin;
  return true;
}

static void step(struct motor* motor) {
  check(motor->made != motor->told, "a step that nobody asked for");
  uint64_t due = motor->due[motor->made % WAITING].clock;
  check(motor->direction == motor->due[motor->made % WAITING].direction, "the wrong direction");
  check(now >= due, "an early step");
  check(motor->fell == 0 || now - motor->fell >= motor->pulse_ticks, "too short a low time");
  if (now - due > latest) latest = now - due;
  ++motor->made;
  motor->position += motor->direction ? 1 : -1;
  motor->rose = now;
}

void hal_output_write(const struct hal_output* output, bool level) {
  struct motor* motor = &motors[output->pin / 2];
  now += random_below(3);
  if (output->pin % 2) {
    check(!motor->step, "a direction that changes within a pulse");
    motor->direction = level;
    return;
  }
  check(motor->step != level, "an edge that is none");
  motor->step = level;
  if (level) {
    step(motor);
  } else {
    check(now - motor->rose >= motor->pulse_ticks, "too short a pulse");
    motor->fell = now;
  }
}

static void pass_time(uint64_t until) {
  while (alarm_set && alarm_clock <= until) {
    if (now < alarm_clock) now = alarm_clock;
    now += random_below(20);
    if (random_below(200) == 0) now += random_below(2000);
    uint32_t again;
    in_interrupt = true;
    alarm_set = stepgen_interrupt(hal_clock(), &again);
    in_interrupt = false;
    if (alarm_set) alarm_clock = widened(again);
  }
  if (now < until) now = until;
}

static void tell(uint8_t index, uint32_t shortest) {
  struct motor* motor = &motors[index];
  struct move* move = &motor->moves[motor->given++ % MOVES];
  ++motor->held;
  if (random_below(4) == 0) motor->next_direction ^= 1;
  *move = (struct move){
      .interval = shortest + random_below(20000),
      .count = (uint16_t)(1 + random_below(30)),
      .direction = motor->next_direction,
  };
  int16_t add = (int16_t)((int32_t)random_below(40) - 20);
  if (add > 0 || (uint32_t)-add * move->count < move->interval) move->add = add;
  bool active = stepgen_active(index);
  uint64_t clock = active ? motor->end + move->interval : now + 1000 + random_below(100000);
  check(stepgen_append(index, move, (uint32_t)clock), "a move is refused");
  uint32_t interval = move->interval;
  for (uint16_t i = 0; i < move->count; ++i) {
    motor->due[motor->told % WAITING].clock = motor->end = clock;
    motor->due[motor->told++ % WAITING].direction = move->direction;
    interval += (uint32_t)(int32_t)move->add;
    clock += interval;
  }
}

static void stop(uint8_t index) {
  stepgen_stop(index);
  motors[index].stopped = true;
  motors[index].told = motors[index].made;
  check(!stepgen_active(index), "a motor that was stopped goes on");
}

static void try_out(uint8_t count, uint32_t shortest) {
  for (uint32_t i = 0; i < OPERATIONS; ++i) {
    uint8_t index = (uint8_t)random_below(count);
    struct motor* motor = &motors[index];
    while (stepgen_reclaim(index) != NULL) --motor->held;
    uint32_t what = random_below(100);
    if (what < 70) {
      bool room = motor->held < MOVES - 100 && motor->told - motor->made < WAITING - 100;
      if (room && !motor->stopped) tell(index, shortest);
    } else if (what < 74) {
      stop(index);
    } else if (what < 80) {
      if (motor->stopped) stepgen_resume(index);
      motor->stopped = false;
    } else {
      pass_time(now + random_below(60000));
    }
    check(stepgen_position(index) == motor->position, "another position");
  }
}

int main(int argc, char** argv) {
  srand(argc > 1 ? (unsigned)atoi(argv[1]) : 0);
  uint64_t steps = 0;
  for (uint32_t round = 0; round < ROUNDS; ++round) {
    now = ((uint64_t)1 << 32) * (1 + round) - random_below(1 << 24);  // soon the clock wraps
    alarm_set = false;
    memset(motors, 0, sizeof motors);
    stepgen_start();
    uint8_t count = (uint8_t)(1 + random_below(HAL_STEPPERS));
    for (uint8_t i = 0; i < count; ++i) {
      motors[i].pulse_ticks = 1 + random_below(300);
      check(stepgen_setup(i, 2 * i, 2 * i + 1, false, (uint16_t)motors[i].pulse_ticks), "no motor");
    }
    try_out(count, round % 2 ? 200 : 1500);
    pass_time(now + 400000000);
    for (uint8_t i = 0; i < count; ++i) {
      check(motors[i].made == motors[i].told, "a step that is missing");
      check(!stepgen_active(i) && !motors[i].step, "a motor that never rests");
      steps += motors[i].made;
    }
  }
  printf("%llu %llu\n", (unsigned long long)steps, (unsigned long long)latest);
  return 0;
}
