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

// Right after a reset, before variables have their values. From then on the chip restarts, with
// outputs as after power-on, if a second or so passes without watchdog_feed().
void watchdog_start(void);
void watchdog_feed(void);  // foreground

// Clocks, and the power of the used modules. No wait for a flag of an oscillator is endless: a chip
// whose clock is wrong sends at a wrong rate, so that it cannot be put to work.
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

// Whether there is such a pin, and it is not the console's.
bool pin_usable(uint16_t pin);

// The converter of analog inputs.
struct analog_pin {
  uint8_t pin, channel;
};
void analog_start(void);
void converter_start(void);
void converter_pin(uint16_t pin);  // connects it
void converter_begin(const struct analog_pin *input);
// True and the value when the conversion that was begun is done.
bool converter_done(uint16_t *value);
