// Sets the function of a pin. Foreground.
#pragma once
#include <stdint.h>

// `pad`: the PAD_ bits in addition to an input with hysteresis, or PAD_NO_OUTPUT alone.
void pin_set(uint16_t pin, uint32_t function, uint32_t pad);
