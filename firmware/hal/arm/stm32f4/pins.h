// Sets the function of a pin. Foreground.
#pragma once
#include <stdbool.h>
#include <stdint.h>

enum pin_mode { PIN_INPUT, PIN_OUTPUT, PIN_ALTERNATE, PIN_ANALOG };

void pin_set(uint16_t pin, enum pin_mode mode, bool pull_up);
void pin_alternate(uint16_t pin, uint32_t function);
