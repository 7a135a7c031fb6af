#include "pins.h"

#include "hal.h"

static const uint32_t usable[] = {0x3FFFFCFF, 0xFFFFFFFF, 0x7FFFFFFF, 0x000007FF};

bool pin_find(uint16_t pin, volatile uint32_t **port, uint32_t *mask) {
  if (pin / 32 >= sizeof usable / sizeof *usable) return false;
  *port = PIO(pin / 32);
  *mask = 1u << pin % 32;
  return usable[pin / 32] & *mask;
}

bool hal_output_setup(struct hal_output *output, uint16_t pin, bool level) {
  if (!pin_find(pin, &output->port, &output->mask)) return false;
  hal_output_write(output, level);
  output->port[PIO_PUDR] = output->mask;
  output->port[PIO_OER] = output->mask;
  output->port[PIO_PER] = output->mask;
  return true;
}

void hal_output_write(const struct hal_output *output, bool level) {
  output->port[level ? PIO_SODR : PIO_CODR] = output->mask;
}

bool hal_input_setup(struct hal_input *input, uint16_t pin, bool pull_up) {
  if (!pin_find(pin, &input->port, &input->mask)) return false;
  input->port[pull_up ? PIO_PUER : PIO_PUDR] = input->mask;
  input->port[PIO_ODR] = input->mask;
  input->port[PIO_PER] = input->mask;
  return true;
}

bool hal_input_read(const struct hal_input *input) { return input->port[PIO_PDSR] & input->mask; }
