#include "pins.h"

#include "hal.h"
#include "layer.h"

// Timers change the direction of pins, too.
static void replace(volatile uint32_t *place, uint32_t shift, uint32_t mask, uint32_t value) {
  hal_irq_t irq = hal_irq_save();
  *place = (*place & ~(mask << shift)) | value << shift;
  hal_irq_restore(irq);
}

void pin_set(uint16_t pin, enum pin_mode mode, bool pull_up) {
  volatile uint32_t *port = GPIO(pin / 32);
  uint32_t shift = 2 * (pin % 32);
  replace(&port[GPIO_PUPDR], shift, 3, pull_up);
  replace(&port[GPIO_MODER], shift, 3, mode);
}

void pin_alternate(uint16_t pin, uint32_t function) {
  uint32_t n = pin % 32;
  replace(&GPIO(pin / 32)[GPIO_AFR + n / 8], 4 * (n % 8), 15, function);
  pin_set(pin, PIN_ALTERNATE, false);
}

bool hal_output_setup(struct hal_output *output, uint16_t pin, bool level) {
  if (!pin_usable(pin)) return false;
  output->set_reset = &GPIO(pin / 32)[GPIO_BSRR];
  output->mask = 1u << pin % 32;
  hal_output_write(output, level);
  pin_set(pin, PIN_OUTPUT, false);
  return true;
}

bool hal_input_setup(struct hal_input *input, uint16_t pin, bool pull_up) {
  if (!pin_usable(pin)) return false;
  input->data = &GPIO(pin / 32)[GPIO_IDR];
  input->mask = 1u << pin % 32;
  pin_set(pin, PIN_INPUT, pull_up);
  return true;
}

bool hal_input_read(const struct hal_input *input) { return *input->data & input->mask; }
