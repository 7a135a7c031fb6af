// SAM3X8E (data sheet 11057): differences from the family.
#pragma once
#include "cortex.h"

#define CHIP_CORE_HZ 84000000UL
#define CHIP_CLOCK_HZ (CHIP_CORE_HZ / 2)
#define CHIP_PLL_FACTOR 14  // 12 MHz × 14 / 2
#define CHIP_IRQS 45
#define HAL_ARENA 49152

#define PIO_BASE 0x400E0E00
#define PMC_BASE 0x400E0600
#define EEFC_BASE 0x400E0A00
#define RSTC_BASE 0x400E1A00
#define WDT_BASE 0x400E1A50
#define UART_BASE 0x400E0800
#define UART_PINS (1u << 8 | 1u << 9)  // of port A
#define UART_RECEIVE_PIN (1u << 8)
#define IS_MODULE_A(pin) false  // outputs of the PWM: all are in module B
#define PWM_BASE 0x40094000
#define ADC_BASE 0x400C0000
#define ADC_ISR REG(ADC_BASE + 0x30)
#define ADC_READY (1u << 24)
// 2 MHz, the longest times to start, to settle and to track.
#define ADC_MODE (20u << 8 | 8u << 16 | 3u << 20 | 15u << 24 | 1u << 28)

// Peripheral numbers.
#define ID_UART 8
#define ID_PIOA 11
#define PORTS 4
#define ID_TC0 27
#define ID_PWM 36
#define ID_ADC 37

#include "sam3.h"

#define TC0_CCR REG(0x40080000)
#define TC0_CMR REG(0x40080004)
#define TC0_CV REG(0x40080010)

// Counts up at half of the master clock, in 32 bits, from 0.
static inline void clock_start(void) {
  PMC_PCER(ID_TC0) = 1u << ID_TC0 % 32;
  TC0_CMR = 1u << 15;
  TC0_CCR = 5;
}
static inline uint32_t chip_clock(void) { return TC0_CV; }
