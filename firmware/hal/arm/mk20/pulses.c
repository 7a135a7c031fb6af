// Pulse width modulation. All channels of a timer share one cycle; the first channel that is set up
// defines it.
#include "hal.h"
#include "layer.h"
#include "pwm.h"

#define SLOWEST 128        // the last divider
#define SC_ON (1u << 3)    // counts the bus clock
#define CHANNEL_PWM 0x28u  // high from the start of a cycle until the value
#define FUNCTION_FTM0 4    // of its pins
#define FUNCTION_OTHERS 3

enum { FTM0, FTM1, FTM2 };
static volatile uint32_t *const timers[] = {
    (volatile uint32_t *)0x40038000,
    (volatile uint32_t *)0x40039000,
    (volatile uint32_t *)0x400B8000,
};

#define ROW(pin, timer, channel) {pin, timer, channel},
static const struct output {
  uint8_t pin, timer, channel;
} outputs[] = {CHIP_PULSES(ROW)};

static void start(volatile uint32_t *timer, uint32_t cycle) {
  struct pwm_cycle made = pwm_cycle(cycle, CHIP_BUS_HZ, SLOWEST, true);
  uint32_t exponent = 0;
  while (1u << exponent < made.divider) ++exponent;
  timer[FTM_MODE] = 1u << 2;  // no write protection
  timer[FTM_CNTIN] = 0;
  timer[FTM_MOD] = made.top - 1;
  timer[FTM_SC] = SC_ON | exponent;
}

bool hal_pwm_setup(struct hal_pwm *pwm, uint16_t pin, uint32_t cycle, uint16_t value) {
  for (const struct output *it = outputs; it < outputs + sizeof outputs / sizeof *outputs; ++it) {
    if (it->pin != pin) continue;
    volatile uint32_t *timer = timers[it->timer];
    if (!pin_usable(pin) || (timer[FTM_CHANNEL(it->channel)] & CHANNEL_PWM)) return false;
    if (!(timer[FTM_SC] & SC_ON)) start(timer, cycle);
    pwm->compare = &timer[FTM_VALUE(it->channel)];
    pwm->top = timer[FTM_MOD] + 1;
    timer[FTM_CHANNEL(it->channel)] = CHANNEL_PWM;
    hal_pwm_write(pwm, value);
    PORT_PCR(pin) = PCR_FUNCTION(it->timer == FTM0 ? FUNCTION_FTM0 : FUNCTION_OTHERS) | PCR_STRONG;
    return true;
  }
  return false;
}

void hal_pwm_write(const struct hal_pwm *pwm, uint16_t value) {
  *pwm->compare = value * pwm->top / HAL_PWM_MAX;
}
