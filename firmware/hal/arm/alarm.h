// SysTick as the alarm for the earliest event.
#pragma once

void alarm_start(void);
void alarm_interrupt(void);  // SysTick
void timer_interrupt(void);  // PendSV
