#include <avr/interrupt.h>
#include <avr/wdt.h>

#include "analog.h"
#include "clock.h"
#include "console.h"
#include "core.h"
#include "hal.h"
#include "pins.h"
#include "scheduler.h"
#include "stepgen.h"

// A boot loader may leave the watchdog on; and after a reset by the watchdog, the watchdog runs
// with its shortest timeout.
__attribute__((naked, used, section(".init3"))) static void stop_watchdog(void) {
  MCUSR = 0;
  wdt_disable();
}

// Restores the modules and pins to their state after a reset.
static void clear(void) {
  TIMSK0 = TIMSK1 = TIMSK2 = TIMSK3 = 0;
  TCCR0A = TCCR0B = TCCR1B = TCCR2A = TCCR2B = TCCR3B = 0;
#ifdef TCNT5
  TIMSK4 = TIMSK5 = TCCR4B = TCCR5B = 0;
#endif
  ADCSRA = UCSR0B = 0;
  volatile uint8_t *port;
  uint8_t mask;
  for (uint8_t pin = 0; pin < 96; ++pin)
    if (pin_find(pin, &port, &mask)) pin_make_input(port, mask, false);
}

// The watchdog is not used here, because some boot loaders hang after its reset.
void hal_reset(void) {
  cli();
  clear();
  __asm__ volatile("jmp 0");
  __builtin_unreachable();
}

int main(void) {
  clear();
  clock_start();
  console_start();
  analog_start();
  stepgen_start();
  core_start(0);
  // If the foreground or the timers hang, or are overloaded, the board restarts with its pins as
  // inputs.
  wdt_enable(WDTO_1S);
  sei();
  for (;;) {
    core_task();
    if (timers_run()) wdt_reset();
  }
}
