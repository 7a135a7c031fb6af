#include "hal.h"
#include "layer.h"
#include "pins.h"

#define CS_ON 1u
#define CS_START (1u << 2)
#define CS_READY (1u << 8)

void converter_start(void) { ADC_CS = CS_ON; }
void converter_pin(uint16_t pin) { pin_set(pin, FUNCTION_NONE, PAD_NO_OUTPUT); }
void converter_begin(const struct analog_pin *input) {
  ADC_CS = CS_ON | CS_START | (uint32_t)input->channel << 12;
}

bool converter_done(uint16_t *value) {
  if (!(ADC_CS & CS_READY)) return false;
  *value = (uint16_t)(ADC_RESULT & 0xFFF);
  return true;
}
