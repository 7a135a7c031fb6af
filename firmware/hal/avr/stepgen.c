// The step generator: a compare unit for each motor. Units whose pins are fixed by the board's file
// are the fastest; a motor with other pins, or one that needs longer pulses, gets a free unit.
//
// The moves of an axis form one list:
//
//   oldest ─ … ─ settled ─ … ─ loaded_end ─ … ─ newest
//   counted in    loaded by     still to be
//   `position`    the unit      loaded
//
// The foreground counts what has been loaded when it comes by, and gives back what it has counted.
#include "stepgen.h"

#include <avr/interrupt.h>
#include <stddef.h>

#include "clock.h"
#include "hal.h"
#include "pins.h"
#include "unit.h"

#define FREE_PIN 0xff
// Ticks that starting a unit takes: a first step that is closer is refused.
#define SOONEST 250
// Minimum length of a pulse without waiting loops.
#define PULSE_FIXED 34  // src/passo/toolchain/avr.py has the same value
#define PULSE_FREE 38
#define PULSE_MAX 480  // 30 µs at 16 MHz
#define PIECE 32768UL

struct wiring {
  uint8_t step_pin, dir_pin;  // or FREE_PIN
  uint8_t bit, timer;
  volatile uint16_t *compare;
  volatile uint8_t *flags, *enable;
};

#define FIXED(n, timer, unit, step_port, step_bit, dir_port, dir_bit) \
  [n] = {PIN_NUMBER(step_port, step_bit),                             \
         PIN_NUMBER(dir_port, dir_bit),                               \
         1 << OCIE##timer##unit,                                      \
         timer,                                                       \
         &OCR##timer##unit,                                           \
         &TIFR##timer,                                                \
         &TIMSK##timer},
#define FREE(n, timer, unit)                                             \
  [n] = {FREE_PIN,          FREE_PIN,     1 << OCIE##timer##unit, timer, \
         &OCR##timer##unit, &TIFR##timer, &TIMSK##timer},

static const struct wiring wiring[BOARD_UNITS] PROGMEM = {BOARD_FIXED(FIXED) BOARD_FREE(FREE)};

volatile struct unit units[BOARD_UNITS];

struct axis {
  volatile struct unit *unit;
  volatile uint16_t *compare;
  volatile uint8_t *flags, *enable;
  uint16_t offset;  // of the unit's timer
  uint8_t bit;
  // Under hal_irq_save(), by foreground and timer context:
  int32_t position;           // as if all settled moves were complete
  struct move *settled;       // the first move that is not counted, or null
  struct move *dropped_from;  // after a stop: the first move that was not loaded
  bool dropped, stopped;
  uint8_t direction;  // of the last queued move
  // Written by the foreground.
  struct move *oldest, *newest;
};

static struct axis axes[BOARD_UNITS];  // zero after a reset
static uint8_t taken[BOARD_UNITS];

void stepgen_start(void) {
  for (uint8_t i = 0; i < BOARD_UNITS; ++i) taken[i] = false;
}

// Returns the unit of these pins, or BOARD_UNITS.
static uint8_t choose(uint16_t step_pin, uint16_t direction_pin, uint16_t pulse_ticks) {
  uint8_t free = BOARD_UNITS;
  for (uint8_t i = 0; i < BOARD_UNITS; ++i) {
    if (taken[i]) continue;
    uint8_t fixed = pgm_read_byte(&wiring[i].step_pin);
    if (fixed == FREE_PIN) {
      if (free == BOARD_UNITS) free = i;
    } else if (fixed == step_pin && pgm_read_byte(&wiring[i].dir_pin) == direction_pin &&
               pulse_ticks <= PULSE_FIXED) {
      return i;
    }
  }
  return free;
}

bool stepgen_setup(uint8_t axis, uint16_t step_pin, uint16_t direction_pin, bool invert,
                   uint16_t pulse_ticks) {
  volatile uint8_t *step_port, *dir_port;
  uint8_t step_mask, dir_mask;
  if (axis >= BOARD_UNITS || pulse_ticks > PULSE_MAX || step_pin == direction_pin ||
      !pin_find(step_pin, &step_port, &step_mask) || !pin_find(direction_pin, &dir_port, &dir_mask))
    return false;
  uint8_t chosen = choose(step_pin, direction_pin, pulse_ticks);
  if (chosen == BOARD_UNITS) return false;
  taken[chosen] = true;
  pin_make_output(step_port, step_mask, invert);
  pin_make_output(dir_port, dir_mask, false);
  volatile struct unit *unit = &units[chosen];
  unit->step_pin = step_port;
  unit->step_mask = step_mask;
  unit->dir_pin = dir_port;
  unit->dir_mask = dir_mask;
  unit->hold = pulse_ticks <= PULSE_FREE ? 1 : (uint8_t)(1 + (pulse_ticks - PULSE_FREE + 2) / 3);
  unit->active = false;
  unit->next = NULL;
  const struct wiring *row = &wiring[chosen];
  struct axis *a = &axes[axis];
  a->unit = unit;
  a->compare = (volatile uint16_t *)pgm_read_word(&row->compare);
  a->flags = (volatile uint8_t *)pgm_read_word(&row->flags);
  a->enable = (volatile uint8_t *)pgm_read_word(&row->enable);
  a->offset = timer_offset[pgm_read_byte(&row->timer)];
  a->bit = pgm_read_byte(&row->bit);
  return true;
}

static int32_t signed_count(uint8_t direction, uint16_t count) {
  return direction & 1 ? (int32_t)count : -(int32_t)count;
}

// Returns the remaining steps of the loaded move.
static uint16_t remaining(const volatile struct unit *unit) {
  if (unit->mode & MODE_WIDE) return unit->left;
  return (uint16_t)(unit->count_high << 8) + (unit->count ? unit->count : 256);
}

// Returns the level of the direction pin for the loaded move.
static uint8_t loaded_direction(const volatile struct unit *unit) {
  return (unit->dir_pin[2] & unit->dir_mask) != 0;
}

static struct move *loaded_end(const struct axis *a) {
  return a->dropped ? a->dropped_from : a->unit->next;
}

// Counts one more loaded move; returns false if all are counted.
static bool settle(struct axis *a) {
  hal_irq_t irq = hal_irq_save();
  struct move *move = a->settled;
  bool found = move != NULL && move != loaded_end(a);
  if (found) {
    a->position += signed_count(move->direction, move->count);
    a->settled = move->next;
  } else if (a->dropped) {
    a->settled = NULL;
    a->dropped = false;
  }
  hal_irq_restore(irq);
  return found;
}

// Starts an idle unit. Its first step comes at `first`, `ticks` from now, and its compare register
// is set; later steps follow from the move.
static void begin(struct axis *a, struct move *move, uint32_t ticks) {
  volatile struct unit *unit = a->unit;
  uint16_t chunks = (uint16_t)((ticks << 1) >> 16);  // pieces of 32768
  if (chunks > 0) --chunks;                          // the first wait takes up to two pieces
  if (chunks & 1) {
    *a->compare += PIECE;
    *a->flags = a->bit;
  }
  unit->mode = move->direction & 1 << MOVE_FAST_BIT ? MODE_WIDE | MODE_THEN_FAST : MODE_WIDE;
  unit->chunks = chunks;
  unit->count = 1;
  unit->count_high = 0;
  unit->mask = chunks == 0 ? unit->step_mask : 0;
  unit->wide = move->interval;
  unit->add = move->add;
  unit->left = move->count;
  unit->next = NULL;
  if (move->direction & 1 << MOVE_TOGGLE_BIT) *unit->dir_pin = unit->dir_mask;
  unit->active = true;
  *a->enable |= a->bit;
}

bool stepgen_append(uint8_t axis, struct move *move, uint32_t first) {
  struct axis *a = &axes[axis];
  volatile struct unit *unit = a->unit;
  int32_t last = (int32_t)(move->interval + (uint32_t)move->add * (uint16_t)(move->count - 1));
  uint8_t direction = move->direction;
  if (move->interval < PIECE && last < (int32_t)PIECE) direction |= 1 << MOVE_FAST_BIT;
  move->next = NULL;
  hal_irq_t irq;
  for (;;) {
    while (settle(a));
    irq = hal_irq_save();
    if (!a->dropped) break;
    hal_irq_restore(irq);
  }
  if ((direction & 1) != a->direction) direction |= 1 << MOVE_TOGGLE_BIT;
  move->direction = direction;
  if (unit->active) {
    if (unit->next == NULL) unit->next = move;
  } else {
    // Set before the clock is read, so that a later match is not missed.
    *a->compare = (uint16_t)first + a->offset;
    *a->flags = a->bit;
    int32_t ticks = (int32_t)(first - hal_clock());
    if (a->stopped || ticks < SOONEST) {
      hal_irq_restore(irq);
      return false;
    }
    begin(a, move, (uint32_t)ticks);
  }
  a->direction = direction & 1;
  if (a->oldest == NULL)
    a->oldest = move;
  else
    a->newest->next = move;
  a->newest = move;
  if (a->settled == NULL) a->settled = move;
  hal_irq_restore(irq);
  return true;
}

bool stepgen_active(uint8_t axis) { return axes[axis].unit->active; }

void stepgen_stop(uint8_t axis) {
  struct axis *a = &axes[axis];
  volatile struct unit *unit = a->unit;
  hal_irq_t irq = hal_irq_save();
  *a->enable &= (uint8_t)~a->bit;
  a->stopped = true;
  if (unit->active) {
    unit->active = false;
    a->direction = loaded_direction(unit);
    a->position -= signed_count(a->direction, remaining(unit));
    a->dropped = true;
    a->dropped_from = unit->next;
    unit->next = NULL;
  }
  hal_irq_restore(irq);
}

void stepgen_resume(uint8_t axis) { axes[axis].stopped = false; }

int32_t stepgen_position(uint8_t axis) {
  struct axis *a = &axes[axis];
  volatile struct unit *unit = a->unit;
  for (;;) {
    while (settle(a));
    hal_irq_t irq = hal_irq_save();
    bool all = a->settled == NULL || a->settled == loaded_end(a);
    int32_t position = a->position;
    if (unit->active) position -= signed_count(loaded_direction(unit), remaining(unit));
    hal_irq_restore(irq);
    if (all) return position;
  }
}

struct move *stepgen_reclaim(uint8_t axis) {
  struct axis *a = &axes[axis];
  struct move *move = a->oldest;
  if (move == NULL) return NULL;
  while (a->settled == move)
    if (!settle(a) && a->settled == move) return NULL;
  a->oldest = move->next;
  return move;
}
