// Motors: queues of moves from the host for the step generator.
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
  struct trsync *group;  // null if the motor is not in a group
  struct stepper *next_of_group;
  uint32_t last;            // clock of the last queued step; written by the foreground
  uint8_t axis, direction;  // written by the foreground
  // Moves are ignored until reset_step_clock. Written by foreground and timer.
  volatile bool halted;
  // For survive (survive_state.h): moves that wait for their commit; the tail, which stops the
  // motor if no further commit comes; and the tail of the next commit. Written by the foreground.
  struct move_list staged, tail, next_tail;
};

// Stops a motor at once. Any context.
void stepper_halt(struct stepper *stepper);
// The next functions are for survive.c, in the foreground.
//
// Appends a move to the tail of the next commit. `args` are those of survive_tail. If the count is
// 0, the interval is a clock, as in reset_step_clock.
void stepper_add_tail(struct stepper *stepper, const uint32_t *args);
// Passes the next staged move with steps to the generator, and the clocks before it. Returns false
// if there is no such move.
bool stepper_give_staged(struct stepper *stepper);
// Replaces the tail by that of the next commit.
void stepper_take_tail(struct stepper *stepper);
// Returns whether the first step after standstill would be too late: the first staged one, or
// without staged steps that of the next tail. HAL_COMMIT_WORK is the time for queueing the moves of
// a commit.
bool stepper_is_late(const struct stepper *stepper);
// Replaces the staged moves by the tail, and drops the next tail.
void stepper_stage_tail(struct stepper *stepper);
// Drops the staged moves and the next tail. If `tail` is true, also drops the tail, and sets staged
// clocks at standstill.
void stepper_forget(struct stepper *stepper, bool tail);
