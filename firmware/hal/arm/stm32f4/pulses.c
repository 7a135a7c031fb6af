// Pulse width modulation by the remaining timers. All channels of a timer share one cycle; the
// first channel that is set up defines it.
#include "hal.h"
#include "layer.h"
#include "pins.h"
#include "pwm.h"

#define APB1(base, function) {base, 2 * CHIP_APB1_HZ, function}  // timers count twice as fast
#define APB2(base, function) {base, 2 * CHIP_APB2_HZ, function}
#define DIVIDERS 65536

enum { TIM1, TIM3, TIM4, TIM5, TIM8, TIM9, TIM10, TIM11, TIM12, TIM13, TIM14 };
static const struct timer_place {
  uint32_t base, hz, function;
} timers[] = {
    [TIM1] = APB2(0x40010000, 1),  [TIM3] = APB1(0x40000400, 2),  [TIM4] = APB1(0x40000800, 2),
    [TIM5] = APB1(0x40000C00, 2),  [TIM8] = APB2(0x40010400, 3),  [TIM9] = APB2(0x40014000, 3),
    [TIM10] = APB2(0x40014400, 3), [TIM11] = APB2(0x40014800, 3), [TIM12] = APB1(0x40001800, 9),
    [TIM13] = APB1(0x40001C00, 9), [TIM14] = APB1(0x40002000, 9),
};

#define ROW(pin, timer, channel) {pin, timer, channel - 1},
static const struct output {
  uint8_t pin, timer, channel;
} outputs[] = {CHIP_PULSES(ROW)};

static void start(volatile uint32_t *timer, const struct timer_place *place, uint32_t cycle) {
  struct pwm_cycle made = pwm_cycle(cycle, place->hz, DIVIDERS, false);
  timer[TIM_PSC] = made.divider - 1;
  timer[TIM_ARR] = made.top - 1;
  // Only timers with bridge outputs have this bit, and they need it.
  if (place == &timers[TIM1] || place == &timers[TIM8]) timer[TIM_BDTR] = 1u << 15;
}

bool hal_pwm_setup(struct hal_pwm *pwm, uint16_t pin, uint32_t cycle, uint16_t value) {
  for (const struct output *it = outputs; it < outputs + sizeof outputs / sizeof *outputs; ++it) {
    if (it->pin != pin || !pin_usable(pin)) continue;
    const struct timer_place *place = &timers[it->timer];
    volatile uint32_t *timer = (volatile uint32_t *)place->base;
    uint32_t enable = 1u << 4 * it->channel;
    if (timer[TIM_CCER] & enable) continue;
    if (!(timer[TIM_CR1] & 1)) start(timer, place, cycle);
    pwm->compare = &timer[TIM_CCR + it->channel];
    pwm->top = timer[TIM_ARR] + 1;
    hal_pwm_write(pwm, value);
    // The output is on until the compare value; a new value acts from the next cycle on.
    timer[TIM_CCMR + it->channel / 2] |= 0x68u << 8 * (it->channel % 2);
    timer[TIM_CCER] |= enable;
    if (!(timer[TIM_CR1] & 1)) timer[TIM_EGR] = 1;  // applies divider, top and compare value
    timer[TIM_CR1] = 1;
    pin_alternate(pin, place->function);
    return true;
  }
  return false;
}

void hal_pwm_write(const struct hal_pwm *pwm, uint16_t value) {
  *pwm->compare = value * pwm->top / HAL_PWM_MAX;
}
