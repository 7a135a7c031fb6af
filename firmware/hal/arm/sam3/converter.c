#include "hal.h"
#include "layer.h"

void converter_start(void) {
  ADC_MR = ADC_MODE;
#ifdef ADC_BIAS
  ADC12B_ACR = ADC_BIAS;
#endif
}

void converter_pin(uint16_t pin) {
  struct hal_input input;
  hal_input_setup(&input, pin, false);
}

void converter_begin(const struct analog_pin *input) {
  ADC_CHDR = ~(1u << input->channel);
  ADC_CHER = 1u << input->channel;
  ADC_CR = 2;  // start
}

bool converter_done(uint16_t *value) {
  if (!(ADC_ISR & ADC_READY)) return false;
  *value = ADC_LCDR & 0xFFF;
  return true;
}
