#include "hal.h"
#include "layer.h"

#define MOR_KEY (0x37u << 16)
#define MOR_CRYSTAL (8u << 8 | 1u << 3 | 1u)  // start of 64 slow cycles; RC oscillator stays on
#define MOR_SELECT_CRYSTAL (1u << 24)
#define SR_CRYSTAL (1u << 0)
#define SR_PLLA (1u << 1)
#define SR_MASTER (1u << 3)
#define SR_SELECTED (1u << 16)
#define MCKR_MAIN 1u
#define MCKR_PLLA 2u
#define MCKR_HALF (1u << 4)
#define PLLA (1u << 29 | (CHIP_PLL_FACTOR - 1u) << 16 | 0x3Fu << 8 | 1u)
#define TIMEOUT_LOOPS 1000000  // reads of a flag
#define SECOND 256             // in cycles of the watchdog's clock
#define WDT_RESETS (1u << 13)

static void await(uint32_t flag) {
  for (uint32_t i = 0; i < TIMEOUT_LOOPS && !(PMC_SR & flag); ++i) continue;
}

// The mode can be written only once. The timeout is 0.7 s to 1.7 s, because the clock has 20 kHz to
// 44 kHz.
void watchdog_start(void) { WDT_MR = WDT_RESETS | SECOND | SECOND << 16; }
void watchdog_feed(void) { WDT_CR = 0xA5000001; }

static void master(uint32_t choice) {
  PMC_MCKR = choice;
  await(SR_MASTER);
}

static void power(uint32_t id) { PMC_PCER(id) = 1u << id % 32; }

void chip_start(void) {
  EEFC0_FMR = EEFC1_FMR = 4u << 8;  // five cycles a read
  CKGR_MOR = MOR_KEY | MOR_CRYSTAL;
  await(SR_CRYSTAL);
  CKGR_MOR = MOR_KEY | MOR_CRYSTAL | MOR_SELECT_CRYSTAL;
  await(SR_SELECTED);
  master(MCKR_MAIN);
  CKGR_PLLAR = PLLA;
  await(SR_PLLA);
  master(MCKR_HALF | MCKR_MAIN);
  master(MCKR_HALF | MCKR_PLLA);
  power(ID_UART);
  for (uint32_t port = 0; port < PORTS; ++port) power(ID_PIOA + port);
  power(ID_PWM);
  power(ID_ADC);
  clock_start();
}

void chip_reset(void) {
  RSTC_CR = 0xA5000005;  // core and modules
  for (;;) {
  }
}
