// Motors: the host's queue for the step generator.
#pragma once
#include <stdbool.h>
#include <stdint.h>

#include "hal.h"
#include "object.h"

struct trsync;

// Moves in the order of their execution.
struct move_list {
  struct move *first, *last;
};

struct stepper {
  struct object object;
  // Written by the foreground under hal_irq_save(), see trsync.h.
  struct trsync *group;  // or null
  struct stepper *next_of_group;
  uint32_t last;            // clock of the last queued step; written by the foreground
  uint8_t axis, direction;  // written by the foreground
  // Steps are ignored until reset_step_clock. Written by foreground and timer.
  volatile bool halted;
  // Written by the foreground: moves that wait for their commit; moves that stop the motor if no
  // further commit comes; and their replacement in the next commit (survive_state.h).
  struct move_list staged, tail, next_tail;
};

// Stops a motor at once. Any context.
void stepper_halt(struct stepper *stepper);
// What survive.c does with moves that wait. Foreground.
//
// Puts a move into the tail of the next commit: `args` as those of survive_tail. Its interval
// counts from the step before; with a count of 0 it is what reset_step_clock sets.
void stepper_add_tail(struct stepper *stepper, const uint32_t *args);
// Passes the next staged move with steps to the generator; returns false if no such move is staged.
bool stepper_give_staged(struct stepper *stepper);
// Replaces the tail by the next tail.
void stepper_take_tail(struct stepper *stepper);
// Returns true if the motor is at standstill, and its first staged step, or the first step of the
// next tail, is past or may be past when the commit is done.
bool stepper_is_late(const struct stepper *stepper);
// Replaces the staged moves by the tail.
void stepper_stage_tail(struct stepper *stepper);
// Drops the staged moves and the next tail. If `tail` is true, also drops the active tail and
// applies staged clocks: the host takes over.
void stepper_forget(struct stepper *stepper, bool tail);
