// Pins by number: 32 a port, from PA0 on.
#pragma once
#include <stdbool.h>
#include <stdint.h>

// False if there is no such pin, or if it is the console's.
bool pin_find(uint16_t pin, volatile uint32_t **port, uint32_t *mask);
