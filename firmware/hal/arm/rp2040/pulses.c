// Pulse width modulation. Both outputs of a slice share one cycle; the first output that is
// configured sets it.
#include "hal.h"
#include "layer.h"
#include "pins.h"
#include "pwm.h"

#define DIVIDERS 255

enum { PWM0, PWM1, PWM2, PWM3, PWM4, PWM5, PWM6, PWM7, SLICES };
enum { A, B };

#define ROW(pin, timer, channel) {pin, timer, channel},
static const struct output {
  uint8_t pin, slice, channel;
} outputs[] = {CHIP_PULSES(ROW)};

static uint8_t used[SLICES];  // one bit for each channel

bool hal_pwm_setup(struct hal_pwm *pwm, uint16_t pin, uint32_t cycle, uint16_t value) {
  for (const struct output *it = outputs; it < outputs + sizeof outputs / sizeof *outputs; ++it) {
    if (it->pin != pin) continue;
    if (!pin_usable(pin) || used[it->slice] & 1u << it->channel) return false;
    volatile uint32_t *slice = PWM_SLICE(it->slice);
    if (!used[it->slice]) {
      struct pwm_cycle made = pwm_cycle(cycle, CHIP_CORE_HZ, DIVIDERS, false);
      slice[PWM_DIV] = made.divider << 4;
      slice[PWM_TOP] = made.top - 1;
      slice[PWM_CC] = 0;
    }
    used[it->slice] |= (uint8_t)(1u << it->channel);
    *pwm = (struct hal_pwm){&slice[PWM_CC], slice[PWM_TOP] + 1, (uint8_t)(16 * it->channel)};
    hal_pwm_write(pwm, value);
    slice[PWM_CSR] = 1;
    pin_set(pin, FUNCTION_PWM, PAD_INPUT | PAD_4_MA | PAD_SCHMITT);
    return true;
  }
  return false;
}

// One register holds the compare values of both outputs.
void hal_pwm_write(const struct hal_pwm *pwm, uint16_t value) {
  uint32_t compare = value * pwm->top / HAL_PWM_MAX;
  hal_irq_t irq = hal_irq_save();
  *pwm->compare = (*pwm->compare & ~(0xFFFFu << pwm->shift)) | compare << pwm->shift;
  hal_irq_restore(irq);
}
