// ADC0 with 12 bits at a 16th of the bus clock, with long samples.
#include "hal.h"
#include "layer.h"

#define TIMEOUT_LOOPS 1000000  // reads of a flag
#define NONE 31u
#define DONE (1u << 7)
#define MODE (3u << 5 | 1u << 4 | 1u << 2 | 1u)
#define INPUTS_B (1u << 4)  // for the channels 4 to 7
#define CALIBRATE (1u << 7)
#define MEAN_OF_32 (1u << 2 | 3u)

void converter_start(void) {
  ADC_SC1A = NONE;
  ADC_CFG1 = MODE;
  ADC_CFG2 = INPUTS_B;
  ADC_SC3 = CALIBRATE | MEAN_OF_32;
  for (uint32_t i = 0; i < TIMEOUT_LOOPS && (ADC_SC3 & CALIBRATE); ++i) continue;
  // The gain from the chip's calibration (reference manual, calibration function).
  uint32_t sum = 0;
  for (uint32_t i = 0; i < ADC_CLPS_WORDS; ++i) sum += ADC_CLPS[i];
  ADC_PG = (sum & 0xFFFF) / 2 | 0x8000;
  ADC_SC3 = 0;
}

void converter_pin(uint16_t pin) { PORT_PCR(pin) = PCR_ANALOG; }
void converter_begin(const struct analog_pin *input) { ADC_SC1A = input->channel; }

bool converter_done(uint16_t *value) {
  if (!(ADC_SC1A & DONE)) return false;
  *value = (uint16_t)(ADC_RA & 0xFFF);
  return true;
}
