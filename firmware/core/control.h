// Identification, time, reset, statistics.
#pragma once
#include <stdbool.h>
#include <stdint.h>

// `clock_high`: the high word of the clock at the start, 0 on a chip.
void control_start(uint32_t clock_high);
// Follows the clock; call it more often than it wraps. The pass of the foreground began at `began`;
// `busy`: it had work.
void control_task(uint32_t began, bool busy);
