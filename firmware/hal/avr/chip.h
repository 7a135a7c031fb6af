// AVR chips with 16-bit timers to spare: ATmega2560, ATmega1284P. What board.h, made by the build,
// says of the board: its clock, its baud rate, and which compare unit drives which motor.
//
// Timers: 1, 3, 4 and 5 run freely at the chip's clock; their compare units make the steps. Timer 1
// is the clock. The alarm has the last compare unit of timer 5, or timer 2 where there is no timer
// 5. Timer 0, and timer 2 if it is free, make pulse width modulation.
#pragma once
#include <avr/io.h>
#include <avr/pgmspace.h>
#include <stdbool.h>
#include <stdint.h>
#include <util/crc16.h>

#include "board.h"

#define HAL_CLOCK_HZ BOARD_CLOCK_HZ
#define HAL_STEPPERS BOARD_UNITS
#define HAL_PWM_MAX 255
#define HAL_SHORTEST_PERIOD 200
#define HAL_ANALOG_WAIT 1800  // 13 cycles of the converter at 1/128 of the clock, and a margin

#ifdef __AVR_ATmega2560__
#define HAL_ARENA 5600
#else
#define HAL_ARENA 12400
#endif
#define HAL_MOVES_MAX 1024
#define HAL_COMMIT_WORK (HAL_CLOCK_HZ / 500)

#define HAL_CONST PROGMEM
#define hal_const8(p) pgm_read_byte(p)
#define hal_const16(p) pgm_read_word(p)
#define hal_const32(p) pgm_read_dword(p)
#define hal_const_pointer(p) pgm_read_word(p)

#define hal_crc16(crc, byte) _crc_ccitt_update(crc, byte)

typedef uint8_t hal_irq_t;

static inline hal_irq_t hal_irq_save(void) {
  uint8_t state = SREG;
  __asm__ volatile("cli" ::: "memory");
  return state;
}

static inline void hal_irq_restore(hal_irq_t state) {
  __asm__ volatile("" ::: "memory");
  SREG = state;
}

static inline uint16_t chip_ticks(void) {
  hal_irq_t irq = hal_irq_save();  // all timers share one buffer for the high byte
  uint16_t ticks = TCNT1;
  hal_irq_restore(irq);
  return ticks;
}

// hal_clock() needs interrupts, so this does not use it: ticks up to 0x7fff.
static inline void chip_wait(uint16_t ticks) {
  uint16_t begin = chip_ticks();
  while ((uint16_t)(chip_ticks() - begin) < ticks) continue;
}
#define HAL_WAIT(ticks) chip_wait(ticks)

// A port's three registers follow each other: PINx, DDRx, PORTx. A 1 written to PINx toggles a pin.
struct hal_output {
  volatile uint8_t *port;
  uint8_t mask;
};
struct hal_input {
  volatile uint8_t *port;
  uint8_t mask;
};
struct hal_analog {
  uint8_t channel;
};
struct hal_pwm {
  volatile uint8_t *compare;
};
