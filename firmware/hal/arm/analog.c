// The converter, one conversion at a time in the order of requests.
#include "hal.h"
#include "layer.h"

#define NOBODY 0xFF
#define ROW(pin, channel) {pin, channel},
static const struct analog_pin inputs[] = {CHIP_ANALOG(ROW)};

// The input of the current conversion, and whether a caller waits for it. Written in timer context
// and, to cancel it, in the foreground.
static volatile uint8_t converting;
static volatile bool awaited;

void analog_start(void) {
  converting = NOBODY;
  converter_start();
}

bool hal_analog_setup(struct hal_analog *analog, uint16_t pin) {
  for (uint8_t i = 0; i < sizeof inputs / sizeof *inputs; ++i) {
    if (inputs[i].pin != pin || !pin_usable(pin)) continue;
    analog->input = i;
    converter_pin(pin);
    return true;
  }
  return false;
}

bool hal_analog_read(const struct hal_analog *analog, uint16_t *value) {
  if (converting != NOBODY && (!awaited || converting == analog->input) && converter_done(value)) {
    converting = NOBODY;
    if (awaited) return true;
  }
  if (converting == NOBODY) {
    converting = analog->input;
    awaited = true;
    converter_begin(&inputs[converting]);
  }
  return false;
}

// A running conversion ends by itself, and its value is dropped.
void hal_analog_cancel(const struct hal_analog *analog) {
  hal_irq_t irq = hal_irq_save();
  if (converting == analog->input) awaited = false;
  hal_irq_restore(irq);
}
