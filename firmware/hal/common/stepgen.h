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

// Provided by the chip's layer. Calls stepgen_interrupt() at `clock`, or as soon after it as
// possible; a newer clock replaces the older one. Not called from stepgen_interrupt().
void stepgen_alarm(uint32_t clock);
// Returns when `clock` has passed: it may be counted from the end of a tick. At most a few
// microseconds.
void stepgen_wait(uint32_t clock);

// Resets all axes, as after power-on.
void stepgen_start(void);
// Called by the chip's layer at `now`; no function of hal.h may interrupt it. Returns true while an
// axis moves, and in `again` the clock of the next call, which may be a little late.
bool stepgen_interrupt(uint32_t now, uint32_t *again);
