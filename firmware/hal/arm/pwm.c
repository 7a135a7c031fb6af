#include "pwm.h"

#include "hal.h"

struct pwm_cycle pwm_cycle(uint32_t cycle, uint32_t timer_hz, uint32_t dividers, bool powers) {
  uint64_t counts = (uint64_t)cycle * timer_hz / HAL_CLOCK_HZ;
  uint64_t most = (uint64_t)dividers * PWM_TOP_MAX;
  uint32_t wanted = (uint32_t)(counts > most ? most : counts);
  if (wanted < HAL_PWM_MAX) wanted = HAL_PWM_MAX;
  uint32_t divider = wanted / (PWM_TOP_MAX + 1) + 1, power = 1;
  while (power < divider) power *= 2;
  if (powers) divider = power;
  return (struct pwm_cycle){divider, wanted / divider};
}
