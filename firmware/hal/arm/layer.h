// What the folder of each chip gives; its registers.h has what must be inline:
//
//   CHIP_CORE_HZ            frequency of the core, and so of SysTick
//   CHIP_CLOCK_HZ           frequency of chip_clock(), which the board file must have too
//   CHIP_UART_IRQ           number of the console's interrupt
//   CHIP_IRQS               interrupts that the chip has
//   chip_clock()            the clock
//   HAL_ARENA, HAL_SHORTEST_PERIOD, HAL_ANALOG_WAIT, HAL_PWM_MAX, struct hal_output, hal_input,
//   hal_pwm                 see hal.h
//
// Pins are numbered 32 a port. board.h says of the chip, as lists for a macro X:
//
//   CHIP_PINS               the pins that can be used, a mask a port
//   CHIP_ANALOG(X)          X(pin, channel)
//   CHIP_PULSES(X)          X(pin, timer, channel), the timers that the firmware leaves alone
#pragma once
#include <stdbool.h>
#include <stdint.h>

// Runs right after a reset, before variables are initialised. From then on the watchdog restarts
// the chip, with outputs as after power-on, about a second after the last watchdog_feed().
void watchdog_start(void);
void watchdog_feed(void);  // foreground

// Sets the clocks, and powers the modules in use. Waits for oscillators are limited: with a wrong
// clock the chip sends at a wrong baud rate, and so never starts work.
void chip_start(void);
_Noreturn void chip_reset(void);

// Sets up the console's UART. The receive interrupt is on; the send interrupt is on demand.
void uart_start(void);
// Returns true and the byte if one was received.
bool uart_take(uint8_t *byte);
// Returns whether the UART takes a byte now.
bool uart_ready(void);
void uart_give(uint8_t byte);
void uart_ask(bool ready);  // enables the interrupt for uart_ready()

// Returns true if the pin exists and the console does not use it.
bool pin_usable(uint16_t pin);

// The analog-to-digital converter.
struct analog_pin {
  uint8_t pin, channel;
};
void analog_start(void);
void converter_start(void);
void converter_pin(uint16_t pin);  // connects the pin to the converter
void converter_begin(const struct analog_pin *input);
// Returns true and the value when the current conversion has ended.
bool converter_done(uint16_t *value);
