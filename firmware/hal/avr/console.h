// The serial port, by interrupts (interrupts.S).
#pragma once

#define CONSOLE_QUIET (1 << RXEN0 | 1 << TXEN0 | 1 << RXCIE0)
#define CONSOLE_SENDING (CONSOLE_QUIET | 1 << UDRIE0)

#ifndef __ASSEMBLER__
void console_start(void);
#endif
