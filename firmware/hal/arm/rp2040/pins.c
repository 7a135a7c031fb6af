#include "pins.h"

#include "hal.h"
#include "layer.h"

void pin_set(uint16_t pin, uint32_t function, uint32_t pad) {
  PAD(pin) = pad;
  IO_CTRL(pin) = function;
}

bool hal_output_setup(struct hal_output *output, uint16_t pin, bool level) {
  if (!pin_usable(pin)) return false;
  output->mask = 1u << pin;
  hal_output_write(output, level);
  SIO_OE_SET = output->mask;
  pin_set(pin, FUNCTION_SIO, PAD_INPUT | PAD_4_MA | PAD_SCHMITT);
  return true;
}

bool hal_input_setup(struct hal_input *input, uint16_t pin, bool pull_up) {
  if (!pin_usable(pin)) return false;
  input->mask = 1u << pin;
  SIO_OE_CLR = input->mask;
  pin_set(pin, FUNCTION_SIO, PAD_INPUT | PAD_4_MA | PAD_SCHMITT | (pull_up ? PAD_PULL_UP : 0));
  return true;
}

bool hal_input_read(const struct hal_input *input) { return SIO_IN & input->mask; }
