// What a pin does. Foreground.
#pragma once
#include <stdint.h>

// `pad`: what of the PAD_ bits it has besides an input with hysteresis, or PAD_NO_OUTPUT alone.
void pin_set(uint16_t pin, uint32_t function, uint32_t pad);
