#include "hal.h"
#include "layer.h"

static const uint32_t usable[] = {CHIP_PINS};

bool pin_usable(uint16_t pin) {
  return pin / 32 < sizeof usable / sizeof *usable && (usable[pin / 32] & 1u << pin % 32);
}
