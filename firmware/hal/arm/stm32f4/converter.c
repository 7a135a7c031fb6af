// 12 bits, 480 cycles of 21 MHz to sample. ADC1 converts; pins of port F need ADC3.
#include "hal.h"
#include "layer.h"
#include "pins.h"

#define SR_DONE (1u << 1)
#define CR2_ON 1u
#define CR2_START (1u << 30)
#define LONGEST_10_TO_18 0x07FFFFFFu
#define LONGEST_0_TO_9 0x3FFFFFFFu
#define PORT_F 5

static volatile uint32_t *busy;  // the converter in use

static void switch_on(volatile uint32_t *adc) {
  adc[ADC_SMPR1] = LONGEST_10_TO_18;
  adc[ADC_SMPR2] = LONGEST_0_TO_9;
  adc[ADC_SQR1] = 0;  // one conversion
  adc[ADC_CR2] = CR2_ON;
}

void converter_start(void) {
  ADC_CCR = 1u << 16;  // a quarter of APB2's clock
  switch_on(ADC1);
  switch_on(ADC3);
  busy = ADC1;
}

void converter_pin(uint16_t pin) { pin_set(pin, PIN_ANALOG, false); }

void converter_begin(const struct analog_pin *input) {
  busy = input->pin / 32 == PORT_F ? ADC3 : ADC1;
  busy[ADC_SQR3] = input->channel;
  busy[ADC_SR] = 0;
  busy[ADC_CR2] = CR2_ON | CR2_START;
}

bool converter_done(uint16_t *value) {
  if (!(busy[ADC_SR] & SR_DONE)) return false;
  *value = (uint16_t)(busy[ADC_DR] & 0xFFF);
  return true;
}
