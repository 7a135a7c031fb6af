// Motors: the host's queue for the step generator.
#pragma once
#include <stdbool.h>
#include <stdint.h>

#include "hal.h"
#include "object.h"

struct trsync;

// Moves in their order.
struct move_list {
  struct move *first, *last;
};

struct stepper {
  struct object object;
  // The foreground's, under hal_irq_save(): see trsync.h.
  struct trsync *group;  // or null
  struct stepper *next_of_group;
  uint32_t last;            // clock of the last step queued; the foreground's
  uint8_t axis, direction;  // the foreground's
  // Steps are ignored until reset_step_clock. Written by foreground and timer.
  volatile bool halted;
  // The foreground's: moves that wait for their commit; the moves that stop the motor if no further
  // commit comes, and those that take their place with the next one (survive_state.h).
  struct move_list staged, tail, next_tail;
};

// Halts a motor at once. Any context.
void stepper_halt(struct stepper *stepper);
// What survive.c does with moves that wait. Foreground.
//
// Puts a move into the tail of the next commit: `args` as those of survive_tail. Its interval
// counts from the step before; with a count of 0 it is what reset_step_clock sets.
void stepper_add_tail(struct stepper *stepper, const uint32_t *args);
// The next staged move with steps goes to the generator; false if there is none.
bool stepper_give_staged(struct stepper *stepper);
// The next tail takes the place of the tail.
void stepper_take_tail(struct stepper *stepper);
// Whether the motor is at standstill, and the first step that is staged, or of the next tail, is
// past, or so near that it may be before a commit is done.
bool stepper_is_late(const struct stepper *stepper);
// The tail takes the place of the staged moves.
void stepper_stage_tail(struct stepper *stepper);
// Drops the staged moves and the next tail. If `tail` is true, also drops the active tail and
// applies staged clocks: the host takes over.
void stepper_forget(struct stepper *stepper, bool tail);
