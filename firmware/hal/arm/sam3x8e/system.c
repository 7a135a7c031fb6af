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
// 12 MHz × 14 / 2 = 84 MHz
#define PLLA_14 (1u << 29 | 13u << 16 | 0x3Fu << 8 | 1u)

static void await(uint32_t flag) {
  while (!(PMC_SR & flag)) {
  }
}

static void master(uint32_t choice) {
  PMC_MCKR = choice;
  await(SR_MASTER);
}

void chip_start(void) {
  WDT_MR = 1u << 15;
  EEFC0_FMR = EEFC1_FMR = 4u << 8;  // five cycles a read
  CKGR_MOR = MOR_KEY | MOR_CRYSTAL;
  await(SR_CRYSTAL);
  CKGR_MOR = MOR_KEY | MOR_CRYSTAL | MOR_SELECT_CRYSTAL;
  await(SR_SELECTED);
  master(MCKR_MAIN);
  CKGR_PLLAR = PLLA_14;
  await(SR_PLLA);
  master(MCKR_HALF | MCKR_MAIN);
  master(MCKR_HALF | MCKR_PLLA);
  PMC_PCER0 = 1u << ID_UART | 0xFu << ID_PIOA | 1u << ID_TC0;
  PMC_PCER1 = 1u << (ID_PWM - 32) | 1u << (ID_ADC - 32);
  TC0_CMR = 1u << 15;  // counts half of the master clock, up and round
  TC0_CCR = 5;         // on, from 0
}

void chip_reset(void) {
  RSTC_CR = 0xA5000005;  // core and modules
  for (;;) {
  }
}
