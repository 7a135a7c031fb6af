// SysTick as the alarm of whoever is due first.
#pragma once

void alarm_start(void);
void alarm_interrupt(void);  // SysTick
void timer_interrupt(void);  // PendSV
