// A compare unit that makes the steps of one motor: what the step interrupt (steps.S) and the rest
// of the layer (stepgen.c) share. Offsets are for the assembler.
#pragma once

#define UNIT_INTERVAL 0    // ticks to the next interrupt
#define UNIT_ADD 2         // what the interval grows by at each interrupt
#define UNIT_COUNT 4       // interrupts until step_next(), modulo 256; 0 stands for 256
#define UNIT_MASK 5        // bit of the step pin, or 0: the next interrupt ends a wait, not a step
#define UNIT_COUNT_HIGH 6  // times that UNIT_COUNT runs out before the move ends
#define UNIT_MODE 7        // 0, or kWide and kThenFast
#define UNIT_NEXT 8        // the move to load next, or null
#define UNIT_CHUNKS 10     // wide: pieces of 32768 ticks that still follow before the step
#define UNIT_WIDE 12       // wide: interval before the step
#define UNIT_LEFT 16       // wide: steps not made yet
#define UNIT_STEP_MASK 18
#define UNIT_TOGGLE 19  // bit of the direction pin if it changes now, else 0
#define UNIT_DIR_MASK 20
#define UNIT_ACTIVE 21    // steps are due
#define UNIT_STEP_PIN 22  // address of the step pin's PINx; writing a 1 there toggles the pin
#define UNIT_DIR_PIN 24
#define UNIT_HOLD 26  // 3-cycle loops that lengthen a pulse, if pins are free
#define UNIT_SIZE 27

#define MODE_WIDE 1
#define MODE_THEN_FAST 2  // after the first step the rest of the move has short intervals

// struct move, and what the layer adds to its direction.
#define MOVE_NEXT 0
#define MOVE_INTERVAL 2
#define MOVE_COUNT 6
#define MOVE_ADD 8
#define MOVE_DIRECTION 10
#define MOVE_FAST_BIT 7    // all intervals are below 32768
#define MOVE_TOGGLE_BIT 6  // the direction changes with this move

#ifndef __ASSEMBLER__
#include <stddef.h>
#include <stdint.h>

#include "hal.h"

// Written by the interrupt while active; otherwise by the foreground and timer context.
struct unit {
  uint16_t interval;
  int16_t add;
  uint8_t count, mask, count_high, mode;
  struct move *next;
  uint16_t chunks;
  uint32_t wide;
  uint16_t left;
  uint8_t step_mask, toggle, dir_mask, active;
  volatile uint8_t *step_pin, *dir_pin;
  uint8_t hold;
};

_Static_assert(offsetof(struct unit, next) == UNIT_NEXT, "steps.S");
_Static_assert(offsetof(struct unit, wide) == UNIT_WIDE, "steps.S");
_Static_assert(offsetof(struct unit, active) == UNIT_ACTIVE, "steps.S");
_Static_assert(offsetof(struct unit, hold) == UNIT_HOLD, "steps.S");
_Static_assert(sizeof(struct unit) == UNIT_SIZE, "steps.S");
_Static_assert(offsetof(struct move, interval) == MOVE_INTERVAL, "steps.S");
_Static_assert(offsetof(struct move, count) == MOVE_COUNT, "steps.S");
_Static_assert(offsetof(struct move, add) == MOVE_ADD, "steps.S");
_Static_assert(offsetof(struct move, direction) == MOVE_DIRECTION, "steps.S");

extern volatile struct unit units[];
#endif
