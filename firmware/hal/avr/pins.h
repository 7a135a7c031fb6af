// Pins by number: eight a port, from port A on, as the dictionary's enumeration has them.
#pragma once
#include <stdbool.h>
#include <stdint.h>

#define PIN_NUMBER(port, bit) (PORT_##port * 8 + (bit))
enum {
  PORT_A,
  PORT_B,
  PORT_C,
  PORT_D,
  PORT_E,
  PORT_F,
  PORT_G,
  PORT_H,
  PORT_I,
  PORT_J,
  PORT_K,
  PORT_L
};

// Returns the address of the pin's PINx and its bit; false if the chip has no such pin, or the
// console uses it.
bool pin_find(uint16_t pin, volatile uint8_t **port, uint8_t *mask);
void pin_make_output(volatile uint8_t *port, uint8_t mask, bool level);
void pin_make_input(volatile uint8_t *port, uint8_t mask, bool pull_up);
