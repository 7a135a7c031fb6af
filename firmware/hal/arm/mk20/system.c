#include "hal.h"
#include "layer.h"

#define TIMEOUT_LOOPS 1000000  // reads of a flag
#define S_CRYSTAL (1u << 1)
#define S_SOURCE (3u << 2)
#define S_INTERNAL (1u << 4)
#define S_PLL (1u << 5)
#define S_LOCKED (1u << 6)
#define C1_CRYSTAL (2u << 6 | 4u << 3)  // of 16 MHz; the other loop's reference is 1/512 of it
#define C1_PLL (0u << 6 | 4u << 3)
#define C2_CRYSTAL (2u << 4 | 1u << 2)
#define C5_EIGHTH 7u
#define C6_PLL (1u << 6 | (CHIP_PLL_FACTOR - 24u))
#define CR_CRYSTAL (1u << 7 | 1u << 3 | 1u << 1)  // on, with 10 pF
#define WATCHDOG_ON 0x01D1u                       // as after a reset, but with the 1 kHz clock
#define WATCHDOG_MS 1000

// The configuration that the chip reads from the flash at 0x400 before it starts: not protected,
// not secured, no NMI pin, no EzPort.
__attribute__((section(".configuration"), aligned(0x400),
               used)) static const uint8_t configuration[16] = {
    0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFE, 0xF9, 0xFF, 0xFF};

static bool comes(uint8_t mask, uint8_t value) {
  for (uint32_t i = 0; i < TIMEOUT_LOOPS; ++i)
    if ((MCG_S & mask) == value) return true;
  return false;
}

// The chip allows 256 cycles for this after a reset, and 20 between the two words.
void watchdog_start(void) {
  WDOG_UNLOCK = 0xC520;
  WDOG_UNLOCK = 0xD928;
  __asm__ volatile("nop\n nop");
  WDOG_TOVALH = 0;
  WDOG_TOVALL = WATCHDOG_MS;
  WDOG_PRESC = 0;
  WDOG_STCTRLH = WATCHDOG_ON;
}

// No interrupt may come between the two words.
void watchdog_feed(void) {
  hal_irq_t irq = hal_irq_save();
  WDOG_REFRESH = 0xA602;
  WDOG_REFRESH = 0xB480;
  hal_irq_restore(irq);
}

// Without a crystal the chip's own oscillator stays on.
static void start_clock(void) {
  OSC_CR = CR_CRYSTAL;
  MCG_C2 = C2_CRYSTAL;
  if (!comes(S_CRYSTAL, S_CRYSTAL)) return;
  MCG_C1 = C1_CRYSTAL;
  comes(S_INTERNAL | S_SOURCE, 2u << 2);
  MCG_C5 = C5_EIGHTH;
  MCG_C6 = C6_PLL;
  SIM_CLKDIV1 = CHIP_DIVIDERS;
  if (!comes(S_PLL | S_LOCKED, S_PLL | S_LOCKED)) return;
  MCG_C1 = C1_PLL;
  comes(S_SOURCE, S_SOURCE);
}

void chip_start(void) {
  start_clock();
  SIM_SCGC3 |= CHIP_SLOW_TIMERS;
  SIM_SCGC4 |= SCGC4_UART1;
  SIM_SCGC5 |= SCGC5_PORTS;
  SIM_SCGC6 |= SCGC6_ADC0 | CHIP_TIMERS;
  cycles_start();
}

void chip_reset(void) {
  SCB_AIRCR = AIRCR_RESET;
  for (;;) {
  }
}
