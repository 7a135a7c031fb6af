// What the folder of each chip gives; its registers.h has what must be inline:
//
//   CHIP_CORE_HZ            frequency of the core, and so of SysTick
//   CHIP_UART_IRQ           number of the console's interrupt
//   CHIP_IRQS               interrupts that the chip has
//   chip_clock()            the clock
//   HAL_ARENA, HAL_SHORTEST_PERIOD, HAL_ANALOG_WAIT, HAL_PWM_MAX, struct hal_output, hal_input,
//   hal_analog, hal_pwm     see hal.h
#pragma once
#include <stdbool.h>
#include <stdint.h>

// Right after a reset: watchdog, clocks, the power of what is used.
void chip_start(void);
_Noreturn void chip_reset(void);

// The console's UART. Its interrupt is on; that of sending only on demand.
void uart_start(void);
// True and the byte if one has come.
bool uart_take(uint8_t *byte);
// Whether a byte can be given to it.
bool uart_ready(void);
void uart_give(uint8_t byte);
void uart_ask(bool ready);  // whether to interrupt when uart_ready()

void analog_start(void);
