#include "hal.h"
#include "layer.h"

#define CR_HSION (1u << 0)
#define CR_HSEON (1u << 16)
#define CR_HSERDY (1u << 17)
#define CR_PLLON (1u << 24)
#define CR_PLLRDY (1u << 25)
// Crystal of 8 MHz, or the chip's own oscillator of 16 MHz: / 8 or 16 × 336 / 2 = 168 MHz
#define PLL(input, source) ((input) | 336u << 6 | 0u << 16 | (source) << 22 | 7u << 24)
#define CFGR_BUSES (5u << 10 | 4u << 13)  // APB1: a quarter, APB2: a half
#define CFGR_PLL 2u
#define ACR_READY (5u | 7u << 8)  // five wait states; prefetch and both caches
#define TIMEOUT_LOOPS 100000      // reads of a flag: tens of milliseconds

static bool comes(volatile uint32_t *place, uint32_t mask, uint32_t value) {
  for (uint32_t i = 0; i < TIMEOUT_LOOPS; ++i)
    if ((*place & mask) == value) return true;
  return false;
}

// Counts 1000 cycles of its own oscillator at 32 kHz / 32: 0.7 s to 1.9 s.
void watchdog_start(void) {
  IWDG_KR = 0xCCCC;
  IWDG_KR = 0x5555;
  IWDG_PR = 3;
  IWDG_RLR = 1000;
}

void watchdog_feed(void) { IWDG_KR = 0xAAAA; }

// A loader may have left the PLL on; while it is on it cannot be set.
static void start_clock(void) {
  RCC_CR |= CR_HSION;
  RCC_CFGR = 0;
  comes(&RCC_CFGR, 3u << 2, 0);
  RCC_CR = (RCC_CR & ~CR_PLLON) | CR_HSEON;
  bool crystal = comes(&RCC_CR, CR_HSERDY, CR_HSERDY);
  RCC_PLLCFGR = crystal ? PLL(8u, 1u) : PLL(16u, 0u);
  RCC_CR |= CR_PLLON;
  FLASH_ACR = ACR_READY;
  comes(&RCC_CR, CR_PLLRDY, CR_PLLRDY);
  RCC_CFGR = CFGR_BUSES;
  RCC_CFGR = CFGR_BUSES | CFGR_PLL;
  comes(&RCC_CFGR, 3u << 2, CFGR_PLL << 2);
}

void chip_start(void) {
  start_clock();
  RCC_AHB1ENR |= AHB1_PORTS;
  RCC_APB1ENR |= APB1_TIMERS | APB1_USARTS;
  RCC_APB2ENR |= APB2_TIMERS | APB2_USART1 | APB2_ADCS;
  // Restores the state after power-on, whatever a loader did.
  RCC_AHB1RSTR = AHB1_PORTS;
  RCC_APB1RSTR = APB1_TIMERS | APB1_USARTS;
  RCC_APB2RSTR = APB2_TIMERS | APB2_USART1 | APB2_ADC_RESET;
  RCC_AHB1RSTR = RCC_APB1RSTR = RCC_APB2RSTR = 0;
  TIM2_CR1 = 1;  // counts up in 32 bits, at half of the core's clock
}

void chip_reset(void) {
  SCB_AIRCR = AIRCR_RESET;
  for (;;) {
  }
}
