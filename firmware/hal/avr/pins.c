#include "pins.h"

#include "hal.h"

#define DIRECTION 1  // offset of DDRx from PINx
#define LEVEL 2      // of PORTx

struct port {
  volatile uint8_t *pin;
  uint8_t bits;  // mask of the existing pins
};

static const struct port ports[] PROGMEM = {
    {&PINA, 0xff}, {&PINB, 0xff}, {&PINC, 0xff},
#ifdef PINE
    {&PIND, 0xff}, {&PINE, 0xfc}, {&PINF, 0xff}, {&PING, 0x3f}, {&PINH, 0xff},
    {0, 0},        {&PINJ, 0xff}, {&PINK, 0xff}, {&PINL, 0xff},
#else
    {&PIND, 0xfc},
#endif
};

bool pin_find(uint16_t pin, volatile uint8_t **port, uint8_t *mask) {
  if (pin >= 8 * sizeof ports / sizeof *ports) return false;
  const struct port *row = &ports[pin / 8];
  *mask = (uint8_t)(1 << pin % 8);
  *port = (volatile uint8_t *)pgm_read_word(&row->pin);
  return pgm_read_byte(&row->bits) & *mask;
}

static void change(volatile uint8_t *reg, uint8_t mask, bool set) {
  hal_irq_t irq = hal_irq_save();
  if (set)
    *reg |= mask;
  else
    *reg &= (uint8_t)~mask;
  hal_irq_restore(irq);
}

void pin_make_output(volatile uint8_t *port, uint8_t mask, bool level) {
  change(port + LEVEL, mask, level);
  change(port + DIRECTION, mask, true);
}

void pin_make_input(volatile uint8_t *port, uint8_t mask, bool pull_up) {
  change(port + DIRECTION, mask, false);
  change(port + LEVEL, mask, pull_up);
}

bool hal_output_setup(struct hal_output *output, uint16_t pin, bool level) {
  if (!pin_find(pin, &output->port, &output->mask)) return false;
  pin_make_output(output->port, output->mask, level);
  return true;
}

void hal_output_write(const struct hal_output *output, bool level) {
  change(output->port + LEVEL, output->mask, level);
}

bool hal_input_setup(struct hal_input *input, uint16_t pin, bool pull_up) {
  if (!pin_find(pin, &input->port, &input->mask)) return false;
  pin_make_input(input->port, input->mask, pull_up);
  return true;
}

bool hal_input_read(const struct hal_input *input) { return *input->port & input->mask; }
