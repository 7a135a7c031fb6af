// Identification, time, reset, statistics.
#pragma once
#include <stdbool.h>
#include <stdint.h>

// `clock_high`: the high word of the clock at the start, 0 on a chip.
void control_start(uint32_t clock_high);
// Follows the clock; `busy` says that the foreground has done something since the last call. To be
// called more often than the clock wraps.
void control_task(bool busy);
