// Pulse width modulation: each channel has a cycle of its own.
#include "hal.h"
#include "layer.h"

#define STEPS HAL_PWM_MAX
#define SLOWEST 10             // exponent of the last prescaler
#define STARTS_HIGH (1u << 9)  // output H is on from the start of a cycle; L is its inverse
enum { PWM0, PWM1, PWM2, PWM3, PWM4, PWM5, PWM6, PWM7 };
enum { L, H };

#define ROW(pin, timer, side) {pin, timer, side},
static const struct output {
  uint8_t pin, channel, side;
} outputs[] = {CHIP_PULSES(ROW)};

// The exponent of the prescaler whose cycle is nearest to the requested one, in ticks.
static uint32_t nearest(uint32_t cycle) {
  const uint32_t ratio = CHIP_CORE_HZ / HAL_CLOCK_HZ;
  uint32_t exponent = 0;
  while (exponent < SLOWEST && cycle > (STEPS << exponent) * 3 / 2 / ratio) ++exponent;
  return exponent;
}

bool hal_pwm_setup(struct hal_pwm *pwm, uint16_t pin, uint32_t cycle, uint16_t value) {
  for (const struct output *it = outputs; it < outputs + sizeof outputs / sizeof *outputs; ++it) {
    if (it->pin != pin) continue;
    volatile uint32_t *port = PIO(pin / 32), *channel = PWM_CHANNEL(it->channel);
    uint32_t mask = 1u << pin % 32;
    if ((PWM_SR & 1u << it->channel) || !pin_usable(pin)) return false;
    channel[PWM_CMR] = nearest(cycle) | (it->side == H ? STARTS_HIGH : 0);
    channel[PWM_CPRD] = STEPS;
    channel[PWM_CDTY] = value;
    PWM_ENA = 1u << it->channel;
    if (IS_MODULE_A(pin))
      port[PIO_ABSR] &= ~mask;
    else
      port[PIO_ABSR] |= mask;
    port[PIO_PDR] = mask;
    pwm->duty = &channel[PWM_CDTYUPD];
    return true;
  }
  return false;
}

void hal_pwm_write(const struct hal_pwm *pwm, uint16_t value) { *pwm->duty = value; }
