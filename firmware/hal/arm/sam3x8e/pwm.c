// Pulse width modulation: eight channels, each with a cycle of its own, on their outputs L.
#include "hal.h"
#include "pins.h"

#define STEPS HAL_PWM_MAX
#define SLOWEST 10  // exponent of the last prescaler
#define P(port, n) (((port) - 'A') * 32 + (n))

static const struct output {
  uint8_t pin, channel;
} outputs[] = {
    {P('A', 21), 0}, {P('B', 16), 0}, {P('C', 2), 0},  {P('A', 12), 1},
    {P('B', 17), 1}, {P('C', 4), 1},  {P('A', 20), 2}, {P('B', 18), 2},
    {P('C', 6), 2},  {P('A', 0), 3},  {P('B', 19), 3}, {P('C', 8), 3},
    {P('C', 21), 4}, {P('C', 22), 5}, {P('C', 23), 6}, {P('C', 24), 7},
};

// The exponent of the prescaler whose cycle is nearest to the wish, in ticks.
static uint32_t nearest(uint32_t cycle) {
  const uint32_t ratio = CHIP_CORE_HZ / HAL_CLOCK_HZ;
  uint32_t exponent = 0;
  while (exponent < SLOWEST && cycle > (STEPS << exponent) * 3 / 2 / ratio) ++exponent;
  return exponent;
}

bool hal_pwm_setup(struct hal_pwm *pwm, uint16_t pin, uint32_t cycle, uint16_t value) {
  for (const struct output *it = outputs; it < outputs + sizeof outputs / sizeof *outputs; ++it) {
    if (it->pin != pin) continue;
    volatile uint32_t *port, *channel = PWM_CHANNEL(it->channel);
    uint32_t mask;
    if ((PWM_SR & 1u << it->channel) || !pin_find(pin, &port, &mask)) return false;
    channel[PWM_CMR] = nearest(cycle);
    channel[PWM_CPRD] = STEPS;
    channel[PWM_CDTY] = value;
    PWM_ENA = 1u << it->channel;
    port[PIO_ABSR] |= mask;  // module B
    port[PIO_PDR] = mask;
    pwm->duty = &channel[PWM_CDTYUPD];
    return true;
  }
  return false;
}

void hal_pwm_write(const struct hal_pwm *pwm, uint16_t value) { *pwm->duty = value; }
