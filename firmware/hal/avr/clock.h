// The clock and the alarm.
#pragma once
#include <stdint.h>

// Starts the timers. A timer's count is that of timer 1 plus its offset.
void clock_start(void);
extern uint16_t timer_offset[6];
