// MK20 chips: common registers. registers.h of each chip has its figures.
#pragma once
#include <stdbool.h>
#include <stdint.h>

#include "cortex.h"

#define REG16(address) (*(volatile uint16_t *)(address))
#define REG8(address) (*(volatile uint8_t *)(address))

#define HAL_SHORTEST_PERIOD (HAL_CLOCK_HZ / 100000)  // 10 µs
#define HAL_ANALOG_WAIT (HAL_CLOCK_HZ / 25000)       // 40 µs: one conversion and a margin

struct hal_output {
  volatile uint32_t *port;
  uint32_t mask;
};
struct hal_input {
  volatile uint32_t *port;
  uint32_t mask;
};
struct hal_pwm {
  volatile uint32_t *compare;
  uint32_t top;
};

#define SIM_SCGC3 REG(0x40048030)
#define SIM_SCGC4 REG(0x40048034)
#define SCGC4_UART1 (1u << 11)
#define SIM_SCGC5 REG(0x40048038)
#define SCGC5_PORTS (31u << 9)  // A to E
#define SIM_SCGC6 REG(0x4004803C)
#define SCGC6_ADC0 (1u << 27)
#define SIM_CLKDIV1 REG(0x40048044)

#define MCG_C1 REG8(0x40064000)
#define MCG_C2 REG8(0x40064001)
#define MCG_C5 REG8(0x40064004)
#define MCG_C6 REG8(0x40064005)
#define MCG_S REG8(0x40064006)
#define OSC_CR REG8(0x40065000)

#define WDOG_STCTRLH REG16(0x40052000)
#define WDOG_TOVALH REG16(0x40052004)
#define WDOG_TOVALL REG16(0x40052006)
#define WDOG_REFRESH REG16(0x4005200C)
#define WDOG_UNLOCK REG16(0x4005200E)
#define WDOG_PRESC REG16(0x40052016)

#define PORT_PCR(pin) REG(0x40049000 + 0x1000 * ((pin) / 32) + 4 * ((pin) % 32))
#define PCR_FUNCTION(n) ((uint32_t)(n) << 8)
#define PCR_ANALOG PCR_FUNCTION(0)
#define PCR_GPIO PCR_FUNCTION(1)
#define PCR_STRONG (1u << 6)
#define PCR_PULL_UP 3u

// Ports: offsets in words from the port's base.
#define GPIO(port) ((volatile uint32_t *)(0x400FF000 + 0x40 * (port)))
#define GPIO_PSOR 1
#define GPIO_PCOR 2
#define GPIO_PDIR 4
#define GPIO_PDDR 5

#ifndef BOARD_UART_UART1
#error "no console on that UART"
#endif
#define CHIP_UART_IRQ CHIP_UART1_IRQ
#define UART_FUNCTION 3
#define UART_BDH REG8(0x4006B000)
#define UART_BDL REG8(0x4006B001)
#define UART_C2 REG8(0x4006B003)
#define UART_S1 REG8(0x4006B004)
#define UART_D REG8(0x4006B007)
#define UART_C4 REG8(0x4006B00A)

// ADC0
#define ADC_SC1A REG(0x4003B000)
#define ADC_CFG1 REG(0x4003B008)
#define ADC_CFG2 REG(0x4003B00C)
#define ADC_RA REG(0x4003B010)
#define ADC_SC3 REG(0x4003B024)
#define ADC_PG REG(0x4003B02C)
#define ADC_CLPS ((volatile uint32_t *)0x4003B038)  // then CLP4 to CLP0
#define ADC_CLPS_WORDS 6

// Timers: offsets in words from the timer's base.
#define FTM_SC 0
#define FTM_MOD 2
#define FTM_CHANNEL(n) (3 + 2 * (n))
#define FTM_VALUE(n) (4 + 2 * (n))
#define FTM_CNTIN 19
#define FTM_MODE 21

static inline uint32_t chip_clock(void) { return DWT_CYCCNT; }

static inline void hal_output_write(const struct hal_output *output, bool level) {
  output->port[level ? GPIO_PSOR : GPIO_PCOR] = output->mask;
}
