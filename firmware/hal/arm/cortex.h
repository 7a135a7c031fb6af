// Registers that all Cortex-M cores have (ARMv7-M reference manual, B3).
#pragma once
#include <stdint.h>

#define REG(address) (*(volatile uint32_t *)(address))

#define SYST_CSR REG(0xE000E010)
#define SYST_RVR REG(0xE000E014)
#define SYST_CVR REG(0xE000E018)
#define SYST_ON 7  // counts core cycles and interrupts
#define SYST_MAX 0xFFFFFF

#define NVIC_ISER(n) REG(0xE000E100 + 4 * ((n) / 32))
#define NVIC_ISPR(n) REG(0xE000E200 + 4 * ((n) / 32))
#define NVIC_IPR(n) REG(0xE000E400 + 4 * ((n) / 4))

#define SCB_ICSR REG(0xE000ED04)
#define ICSR_PENDSTSET (1u << 26)
#define ICSR_PENDSVSET (1u << 28)
#define SCB_VTOR REG(0xE000ED08)
#define SCB_AIRCR REG(0xE000ED0C)
#define AIRCR_RESET 0x05FA0004u
#define SCB_SHPR3 REG(0xE000ED20)
#define SHPR3_PENDSV_LAST 0x00F00000u

// Cycle counter of the core; an M0 core has none.
#define DWT_CTRL REG(0xE0001000)
#define DWT_CYCCNT REG(0xE0001004)
#define SCB_DEMCR REG(0xE000EDFC)
static inline void cycles_start(void) {
  SCB_DEMCR |= 1u << 24;  // lets the module work
  DWT_CTRL |= 1;
}
