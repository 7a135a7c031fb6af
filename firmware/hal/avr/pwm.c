// Pulse width modulation by the 8-bit timers in phase correct mode: 0 is always low, 255 always
// high. Both outputs of a timer share one cycle.
#include "hal.h"
#include "pins.h"

#define CYCLE 510  // counts of the timer

struct channel {
  uint8_t pin, connect;
  volatile uint8_t *compare, *mode;  // OCRnx; TCCRnA, directly before TCCRnB
};

static const struct channel channels[] PROGMEM = {
#ifdef __AVR_ATmega2560__
    {PIN_NUMBER(B, 7), 1 << COM0A1, &OCR0A, &TCCR0A},
    {PIN_NUMBER(G, 5), 1 << COM0B1, &OCR0B, &TCCR0A},
    {PIN_NUMBER(B, 4), 1 << COM2A1, &OCR2A, &TCCR2A},
    {PIN_NUMBER(H, 6), 1 << COM2B1, &OCR2B, &TCCR2A},
#else
    {PIN_NUMBER(B, 3), 1 << COM0A1, &OCR0A, &TCCR0A},
    {PIN_NUMBER(B, 4), 1 << COM0B1, &OCR0B, &TCCR0A},
#endif
};

// Exponents of the prescalers, by the value of the clock select bits from 1 on.
static const uint8_t prescalers0[] PROGMEM = {0, 3, 6, 8, 10};
static const uint8_t prescalers2[] PROGMEM = {0, 3, 5, 6, 7, 8, 10};

// Returns the clock select bits whose cycle is nearest to the requested one.
static uint8_t nearest(const uint8_t *prescalers, uint8_t count, uint32_t cycle) {
  uint8_t best = 1;
  uint32_t least = UINT32_MAX;
  for (uint8_t i = 0; i < count; ++i) {
    uint32_t made = (uint32_t)CYCLE << pgm_read_byte(&prescalers[i]);
    uint32_t error = made > cycle ? made - cycle : cycle - made;
    if (error < least) {
      least = error;
      best = i + 1;
    }
  }
  return best;
}

bool hal_pwm_setup(struct hal_pwm *pwm, uint16_t pin, uint32_t cycle, uint16_t value) {
  for (uint8_t i = 0; i < sizeof channels / sizeof *channels; ++i) {
    if (pgm_read_byte(&channels[i].pin) != pin) continue;
    volatile uint8_t *mode = (volatile uint8_t *)pgm_read_word(&channels[i].mode);
    uint8_t clock = mode == &TCCR0A ? nearest(prescalers0, sizeof prescalers0, cycle)
                                    : nearest(prescalers2, sizeof prescalers2, cycle);
    if (mode[1] != 0 && mode[1] != clock) return false;
    pwm->compare = (volatile uint8_t *)pgm_read_word(&channels[i].compare);
    *pwm->compare = (uint8_t)value;
    mode[0] |= pgm_read_byte(&channels[i].connect) | 1 << WGM00;
    mode[1] = clock;
    volatile uint8_t *port;
    uint8_t mask;
    pin_find(pin, &port, &mask);
    pin_make_output(port, mask, false);
    return true;
  }
  return false;
}

void hal_pwm_write(const struct hal_pwm *pwm, uint16_t value) { *pwm->compare = (uint8_t)value; }
