// Chains of lights, bit by bit. A port's register holds other pins that interrupts change, so it is
// read in the same span without interrupts in which it is written.
#include "hal.h"

#define LEVEL 2  // offset of PORTx from PINx

// Cycles from edge to edge: 5 for a 0, 14 for a 1. At 16 to 20 MHz these are 0.25 to 0.31 us, and
// 0.7 to 0.88 us. A bit takes some 40 cycles, during 28 of which interrupts are off.
#define BIT                     \
  "in %[irq], __SREG__\n"       \
  "cli\n"                       \
  "lds %A[now], %[clock]\n"     \
  "lds %B[now], %[clock] + 1\n" \
  "ld %[low], Z\n"              \
  "mov %[high], %[low]\n"       \
  "or %[high], %[mask]\n"       \
  "and %[low], %[others]\n"     \
  "st Z, %[high]\n"             \
  "nop\n nop\n"                 \
  "sbrs %[bits], 7\n"           \
  "st Z, %[low]\n"              \
  ".rept 8\n nop\n .endr\n"     \
  "st Z, %[low]\n"              \
  "out __SREG__, %[irq]\n"

bool hal_lights_send(const struct hal_output *output, const uint8_t *data, uint16_t size,
                     uint16_t bit_max) {
  volatile uint8_t *port = output->port + LEVEL;
  const uint8_t mask = output->mask, others = (uint8_t)~mask;
  uint16_t last = chip_ticks();
  for (; size > 0; --size) {
    uint8_t bits = *data++;
    for (uint8_t i = 8; i > 0; --i) {
      uint16_t now;
      uint8_t low, high, irq;
      __asm__ volatile(
          BIT
          : [now] "=&r"(now), [low] "=&r"(low), [high] "=&r"(high), [irq] "=&r"(irq)
          : [clock] "i"(&TCNT1), [mask] "r"(mask), [others] "r"(others), [bits] "r"(bits), "z"(port)
          : "memory");
      if ((uint16_t)(now - last) > bit_max) return false;
      last = now;
      bits = (uint8_t)(bits << 1);
    }
  }
  return true;
}
