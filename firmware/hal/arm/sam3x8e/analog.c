// The converter, one conversion at a time for whoever asks first.
#include "hal.h"
#include "layer.h"
#include "pins.h"

#define NOBODY 0xFF
#define P(port, n) (((port) - 'A') * 32 + (n))

// In the order of the converter's channels.
static const uint8_t pins[] = {
    P('A', 2),  P('A', 3),  P('A', 4),  P('A', 6),  P('A', 22), P('A', 23), P('A', 24), P('A', 16),
    P('B', 12), P('B', 13), P('B', 17), P('B', 18), P('B', 19), P('B', 20), P('B', 21),
};

// The channel that is being converted, and whether anybody waits for it; timer context and, for
// cancelling, foreground.
static volatile uint8_t converting;
static volatile bool awaited;

void analog_start(void) {
  converting = NOBODY;
  // 2 MHz, the longest times to start, to settle and to track.
  ADC_MR = 20u << 8 | 8u << 16 | 3u << 20 | 15u << 24 | 1u << 28;
}

bool hal_analog_setup(struct hal_analog *analog, uint16_t pin) {
  for (uint8_t i = 0; i < sizeof pins; ++i) {
    if (pins[i] != pin) continue;
    struct hal_input input;
    analog->channel = i;
    return hal_input_setup(&input, pin, false);
  }
  return false;
}

bool hal_analog_read(const struct hal_analog *analog, uint16_t *value) {
  bool done = converting != NOBODY && ADC_ISR & ADC_DRDY;
  if (done && (!awaited || converting == analog->channel)) {
    *value = ADC_LCDR & 0xFFF;
    ADC_CHDR = 1u << converting;
    converting = NOBODY;
    if (awaited) return true;
  }
  if (converting == NOBODY) {
    converting = analog->channel;
    awaited = true;
    ADC_CHER = 1u << analog->channel;
    ADC_CR = 2;  // start
  }
  return false;
}

// A conversion under way ends by itself, and its value is thrown away.
void hal_analog_cancel(const struct hal_analog *analog) {
  hal_irq_t irq = hal_irq_save();
  if (converting == analog->channel) awaited = false;
  hal_irq_restore(irq);
}
