#include "hal.h"
#include "layer.h"

#define CRYSTAL_FIRST 18  // PTA18, PTA19 belong to the crystal: using them would stop the chip
#define CRYSTAL_LAST 19

static bool usable(uint16_t pin) {
  return pin_usable(pin) && (pin < CRYSTAL_FIRST || pin > CRYSTAL_LAST);
}

// Timers change the direction of pins, too.
static void direct(volatile uint32_t *port, uint32_t mask, bool out) {
  hal_irq_t irq = hal_irq_save();
  port[GPIO_PDDR] = out ? port[GPIO_PDDR] | mask : port[GPIO_PDDR] & ~mask;
  hal_irq_restore(irq);
}

bool hal_output_setup(struct hal_output *output, uint16_t pin, bool level) {
  if (!usable(pin)) return false;
  output->port = GPIO(pin / 32);
  output->mask = 1u << pin % 32;
  hal_output_write(output, level);
  direct(output->port, output->mask, true);
  PORT_PCR(pin) = PCR_GPIO | PCR_STRONG;
  return true;
}

bool hal_input_setup(struct hal_input *input, uint16_t pin, bool pull_up) {
  if (!usable(pin)) return false;
  input->port = GPIO(pin / 32);
  input->mask = 1u << pin % 32;
  direct(input->port, input->mask, false);
  PORT_PCR(pin) = PCR_GPIO | (pull_up ? PCR_PULL_UP : 0);
  return true;
}

bool hal_input_read(const struct hal_input *input) { return input->port[GPIO_PDIR] & input->mask; }
