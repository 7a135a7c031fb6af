// SAM3U4E (data sheet 6430): differences from the family.
#pragma once
#include "cortex.h"

#define CHIP_CORE_HZ 96000000UL
#define CHIP_CLOCK_HZ CHIP_CORE_HZ
#define CHIP_PLL_FACTOR 16  // 12 MHz × 16 / 2
#define CHIP_IRQS 30
#define HAL_ARENA 22528

#define PIO_BASE 0x400E0C00
#define PMC_BASE 0x400E0400
#define EEFC_BASE 0x400E0800
#define RSTC_BASE 0x400E1200
#define WDT_BASE 0x400E1250
#define UART_BASE 0x400E0600
#define UART_PINS (1u << 11 | 1u << 12)  // of port A
#define UART_RECEIVE_PIN (1u << 11)
#define IS_MODULE_A(pin) (((pin) >= 32 && (pin) < 36) || (pin) >= 93)  // PWM: PB0-3, PC29-31
#define PWM_BASE 0x4008C000
// The 12-bit converter.
#define ADC_BASE 0x400A8000
#define ADC_ISR REG(ADC_BASE + 0x1C)
#define ADC_READY (1u << 16)
// 2 MHz, the longest time to start, the longest to sample.
#define ADC_MODE (23u << 8 | 255u << 16 | 15u << 24)
#define ADC_BIAS (1u << 8)  // of the converter: for up to 5 MHz; gain 1

// Peripheral numbers.
#define ID_UART 8
#define ID_PIOA 10
#define PORTS 3
#define ID_PWM 25
#define ID_ADC 26

#include "sam3.h"

// The timers have 16 bits.
static inline void clock_start(void) { cycles_start(); }
static inline uint32_t chip_clock(void) { return DWT_CYCCNT; }
