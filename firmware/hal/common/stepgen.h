// The step generator for chips with one alarm to spare: all axes share it.
//
// Each axis holds its moves in one list, in their order:
//
//   oldest → … → next to load → … → newest
//   \_ loaded: the foreground takes them back (stepgen_reclaim)
//                 \_ waiting: the interrupt loads them
//
// `oldest` and `newest` are the foreground's; what else the interrupt writes, the foreground
// touches under hal_irq_save().
#pragma once
#include <stdbool.h>
#include <stdint.h>

#include "hal.h"

// What the chip's layer gives. Calls stepgen_interrupt() at `clock` or as soon after as can be; a
// newer clock replaces the older. Not to be called from stepgen_interrupt().
void stepgen_alarm(uint32_t clock);
// Returns when `clock` is over, since it may be reckoned from the end of a tick: a few microseconds
// at most.
void stepgen_wait(uint32_t clock);

// Forgets all axes, as after power-on.
void stepgen_start(void);
// Called by the chip's layer at `now`, and interrupted by nothing that calls the functions of
// hal.h. While an axis moves it is true, and `again` the clock at which it is to be called next, or
// soon after.
bool stepgen_interrupt(uint32_t now, uint32_t *again);
