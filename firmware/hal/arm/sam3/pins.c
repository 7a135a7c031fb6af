#include "hal.h"
#include "layer.h"

bool hal_output_setup(struct hal_output *output, uint16_t pin, bool level) {
  if (!pin_usable(pin)) return false;
  output->port = PIO(pin / 32);
  output->mask = 1u << pin % 32;
  hal_output_write(output, level);
  output->port[PIO_PUDR] = output->mask;
  output->port[PIO_OER] = output->mask;
  output->port[PIO_PER] = output->mask;
  return true;
}

bool hal_input_setup(struct hal_input *input, uint16_t pin, bool pull_up) {
  if (!pin_usable(pin)) return false;
  input->port = PIO(pin / 32);
  input->mask = 1u << pin % 32;
  input->port[pull_up ? PIO_PUER : PIO_PUDR] = input->mask;
  input->port[PIO_ODR] = input->mask;
  input->port[PIO_PER] = input->mask;
  return true;
}

bool hal_input_read(const struct hal_input *input) { return input->port[PIO_PDSR] & input->mask; }
