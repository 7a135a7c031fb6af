// Identification, time, reset, statistics.
#pragma once
#include <stdbool.h>
#include <stdint.h>

// `clock_high`: the high word of the clock at the start, 0 on a chip.
void control_start(uint32_t clock_high);
// Tracks the clock; call it more often than the clock wraps. `began`: start of the pass of the
// foreground. `busy`: the pass had work.
void control_task(uint32_t began, bool busy);
