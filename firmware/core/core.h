// The firmware, as the hardware layer starts and drives it.
#pragma once
#include <stdbool.h>
#include <stdint.h>

// Once after each reset, with interrupts off or on. `clock_high`: see control_start().
void core_start(uint32_t clock_high);
// Runs one pass of the foreground; returns false if there was nothing to do. Call it in a loop;
// after false the chip may sleep until an interrupt.
bool core_task(void);
