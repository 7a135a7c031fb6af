// The converter, one conversion at a time in the order of requests.
#include "analog.h"

#include "hal.h"
#include "pins.h"

#define NOBODY 0xff

// The channel of the current conversion; written in timer context and, to cancel it, in the
// foreground.
static volatile uint8_t converting;

void analog_start(void) {
  converting = NOBODY;
  ADCSRA = 1 << ADEN | 1 << ADPS2 | 1 << ADPS1 | 1 << ADPS0;
}

static bool channel_of(uint16_t pin, uint8_t *channel) {
  *channel = pin % 8;
#ifdef PINF
  if (pin / 8 == PORT_K) *channel += 8;
  return pin / 8 == PORT_F || pin / 8 == PORT_K;
#else
  return pin / 8 == PORT_A;
#endif
}

bool hal_analog_setup(struct hal_analog *analog, uint16_t pin) {
  volatile uint8_t *port;
  uint8_t mask;
  if (!channel_of(pin, &analog->channel) || !pin_find(pin, &port, &mask)) return false;
  pin_make_input(port, mask, false);
  return true;
}

bool hal_analog_read(const struct hal_analog *analog, uint16_t *value) {
  if (ADCSRA & 1 << ADSC) return false;
  if (converting == analog->channel) {
    converting = NOBODY;
    *value = ADC;
    return true;
  }
  if (converting != NOBODY) return false;
  converting = analog->channel;
#ifdef MUX5
  ADCSRB = analog->channel & 8 ? 1 << MUX5 : 0;
#endif
  ADMUX = 1 << REFS0 | (analog->channel & 7);
  ADCSRA |= 1 << ADSC;
  return false;
}

void hal_analog_cancel(const struct hal_analog *analog) {
  hal_irq_t irq = hal_irq_save();
  if (converting == analog->channel) converting = NOBODY;
  hal_irq_restore(irq);
}
