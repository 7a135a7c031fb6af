#include "hal.h"
#include "layer.h"

#define TIMEOUT_LOOPS 1000000  // reads of a flag
#define STABLE (1u << 31)
#define LOCKED (1u << 31)
#define PWR_FRACTIONS_OFF (1u << 2)
#define PWR_DIVIDERS_OFF (1u << 3)
#define ON_XOSC 2u
#define ON_PLL 1u
#define PERIPHERAL_ON (1u << 11)
#define WATCHDOG_ON (1u << 30)
#define WATCHDOG_NOW (1u << 31)
#define WATCHDOG_LONGEST 0xFFFFFFu
#define ALL_BUT_OSCILLATORS 0x1FFFCu
#define USED                                                                                     \
  (RESET_ADC | RESET_IO | RESET_PADS | RESET_PLL_SYS | RESET_PLL_USB | RESET_PWM | RESET_TIMER | \
   RESET_UART0)

static bool comes(volatile uint32_t *place, uint32_t mask, uint32_t value) {
  for (uint32_t i = 0; i < TIMEOUT_LOOPS; ++i)
    if ((*place & mask) == value) return true;
  return false;
}

static void wait_for_crystal(void) {
  XOSC_STARTUP = 188;  // of 256 cycles: 4 ms
  XOSC_CTRL = 0xFABu << 12 | 0xAA0;
  comes(&XOSC_STATUS, STABLE, STABLE);
}

// 12 MHz × factor / (divider1 · divider2)
static void start_pll(volatile uint32_t *pll, uint32_t factor, uint32_t first, uint32_t second) {
  pll[PLL_CS] = 1;
  pll[PLL_FBDIV] = factor;
  pll[PLL_PWR] = PWR_FRACTIONS_OFF | PWR_DIVIDERS_OFF;
  comes(&pll[PLL_CS], LOCKED, LOCKED);
  pll[PLL_PRIM] = first << 16 | second << 12;
  pll[PLL_PWR] = PWR_FRACTIONS_OFF;
}

// The watchdog generates the tick of the timer: until the crystal is up, the timer stands still.
void watchdog_start(void) {
  PSM_WDSEL = ALL_BUT_OSCILLATORS;
  WATCHDOG_LOAD = WATCHDOG_LONGEST;
  WATCHDOG_CTRL = WATCHDOG_ON;
}

// The watchdog counts two each tick: 0.7 s.
void watchdog_feed(void) { WATCHDOG_LOAD = WATCHDOG_LONGEST; }

void chip_start(void) {
  // Starts from the ring oscillator and the state after a reset.
  CLEAR(CLK_SYS) = 1;  // from CLK_REF
  comes(&CLK_SYS_SELECTED, 1, 1);
  CLK_REF_CTRL = 0;
  comes(&CLK_REF_SELECTED, 1, 1);
  SET(RESETS) = USED;
  CLEAR(RESETS) = USED & ~RESET_UART0 & ~RESET_ADC;
  comes(&RESETS_DONE, USED & ~RESET_UART0 & ~RESET_ADC, USED & ~RESET_UART0 & ~RESET_ADC);
  wait_for_crystal();
  CLK_REF_CTRL = ON_XOSC;
  comes(&CLK_REF_SELECTED, 1u << ON_XOSC, 1u << ON_XOSC);
  WATCHDOG_TICK = 1u << 9 | 1;  // the timer counts each of its cycles
  start_pll(PLL_SYS, 120, 6, 2);
  start_pll(PLL_USB, 100, 5, 5);
  REG(CLK_SYS) = 0;  // the other source is PLL_SYS
  REG(CLK_SYS) = ON_PLL;
  comes(&CLK_SYS_SELECTED, 1u << ON_PLL, 1u << ON_PLL);
  CLK_PERI_CTRL = PERIPHERAL_ON;
  CLK_ADC_CTRL = PERIPHERAL_ON;  // 48 MHz from PLL_USB
  CLEAR(RESETS) = RESET_UART0 | RESET_ADC;
  comes(&RESETS_DONE, RESET_UART0 | RESET_ADC, RESET_UART0 | RESET_ADC);
  SIO_OE_CLR = 0x3FFFFFFF;
}

void chip_reset(void) {
  PSM_WDSEL = ALL_BUT_OSCILLATORS;
  WATCHDOG_CTRL = WATCHDOG_NOW;
  for (;;) {
  }
}
