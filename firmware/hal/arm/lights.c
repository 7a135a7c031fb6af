// Chains of lights, bit by bit. The clock of some chips is too slow to time a pulse, so loops do.
#include "hal.h"

// Rounds of the loop in so many nanoseconds. A round is 3 or 4 cycles.
#define ROUNDS(ns) ((uint32_t)(CHIP_CORE_HZ / 1000000 * (ns) / 4000))
#define PULSE_0 ROUNDS(320)  // at least 0.24 us
#define PULSE_1 ROUNDS(1000)
#define LOW ROUNDS(1000)  // after each pulse

static inline void spin(uint32_t rounds) {
  __asm__ volatile(".syntax unified\n1: subs %0, #1\n bne 1b" : "+l"(rounds) : : "cc");
}

bool hal_lights_send(const struct hal_output *output, const uint8_t *data, uint16_t size,
                     uint16_t bit_max) {
  uint32_t last = hal_clock();
  for (; size > 0; --size) {
    uint8_t bits = *data++;
    for (uint8_t i = 8; i > 0; --i, bits = (uint8_t)(bits << 1)) {
      uint32_t rounds = bits & 0x80 ? PULSE_1 : PULSE_0;
      hal_irq_t irq = hal_irq_save();
      uint32_t now = hal_clock();
      if (now - last > bit_max) {
        hal_irq_restore(irq);
        return false;
      }
      hal_output_write(output, true);
      spin(rounds);
      hal_output_write(output, false);
      hal_irq_restore(irq);
      last = now;
      spin(LOW);
    }
  }
  return true;
}
