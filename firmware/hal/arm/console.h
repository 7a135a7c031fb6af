// The console's rings, between its interrupt and the foreground.
#pragma once

void console_start(void);
void console_interrupt(void);
