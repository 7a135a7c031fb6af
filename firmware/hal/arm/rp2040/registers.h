// RP2040 (data sheet RP-008371-DS): addresses of what the layer uses, and the chip's figures.
#pragma once
#include <stdbool.h>
#include <stdint.h>

#include "cortex.h"

#define CHIP_CORE_HZ 120000000UL
#define CHIP_CLOCK_HZ 12000000UL
#define CHIP_IRQS 26

#define HAL_ARENA 49152
#define HAL_SHORTEST_PERIOD 120  // 10 µs
#define HAL_ANALOG_WAIT 48       // 4 µs: one conversion and a margin

struct hal_output {
  uint32_t mask;
};
struct hal_input {
  uint32_t mask;
};
struct hal_pwm {
  volatile uint32_t *compare;
  uint32_t top;
  uint8_t shift;
};

// Offsets of a register's aliases: writing there sets bits, or clears them.
#define SET(place) REG((place) + 0x2000)
#define CLEAR(place) REG((place) + 0x3000)

#define CLK_REF_CTRL REG(0x40008030)
#define CLK_REF_SELECTED REG(0x40008038)
#define CLK_SYS 0x4000803C
#define CLK_SYS_SELECTED REG(0x40008044)
#define CLK_PERI_CTRL REG(0x40008048)
#define CLK_ADC_CTRL REG(0x40008060)

#define RESETS 0x4000C000
#define RESETS_DONE REG(0x4000C008)
#define RESET_ADC (1u << 0)
#define RESET_IO (1u << 5)
#define RESET_PADS (1u << 8)
#define RESET_PLL_SYS (1u << 12)
#define RESET_PLL_USB (1u << 13)
#define RESET_PWM (1u << 14)
#define RESET_TIMER (1u << 21)
#define RESET_UART0 (1u << 22)

#define PSM_WDSEL REG(0x40010008)

#define IO_CTRL(pin) REG(0x40014004 + 8 * (pin))
#define FUNCTION_UART 2
#define FUNCTION_PWM 4
#define FUNCTION_SIO 5
#define FUNCTION_NONE 31
#define PAD(pin) REG(0x4001C004 + 4 * (pin))
#define PAD_NO_OUTPUT (1u << 7)
#define PAD_INPUT (1u << 6)
#define PAD_4_MA (1u << 4)
#define PAD_PULL_UP (1u << 3)
#define PAD_SCHMITT (1u << 1)

#define XOSC_CTRL REG(0x40024000)
#define XOSC_STATUS REG(0x40024004)
#define XOSC_STARTUP REG(0x4002400C)

// PLLs: offsets in words from the PLL's base.
#define PLL_SYS ((volatile uint32_t *)0x40028000)
#define PLL_USB ((volatile uint32_t *)0x4002C000)
#define PLL_CS 0
#define PLL_PWR 1
#define PLL_FBDIV 2
#define PLL_PRIM 3

#ifndef BOARD_UART_UART0
#error "no console on that UART"
#endif
#define CHIP_UART_IRQ 20
#define UART_DR REG(0x40034000)
#define UART_FR REG(0x40034018)
#define UART_IBRD REG(0x40034024)
#define UART_FBRD REG(0x40034028)
#define UART_LCR_H REG(0x4003402C)
#define UART_CR REG(0x40034030)
#define UART_IFLS REG(0x40034034)
#define UART_IMSC REG(0x40034038)

#define ADC_CS REG(0x4004C000)
#define ADC_RESULT REG(0x4004C004)

// Slices: offsets in words from the slice's base.
#define PWM_SLICE(n) ((volatile uint32_t *)(0x40050000 + 0x14 * (n)))
#define PWM_CSR 0
#define PWM_DIV 1
#define PWM_CTR 2
#define PWM_CC 3
#define PWM_TOP 4

#define TIMER_RAW_LOW REG(0x40054028)

#define WATCHDOG_CTRL REG(0x40058000)
#define WATCHDOG_LOAD REG(0x40058004)
#define WATCHDOG_TICK REG(0x4005802C)

#define SIO_IN REG(0xD0000004)
#define SIO_OUT_SET REG(0xD0000014)
#define SIO_OUT_CLR REG(0xD0000018)
#define SIO_OE_SET REG(0xD0000024)
#define SIO_OE_CLR REG(0xD0000028)

static inline uint32_t chip_clock(void) { return TIMER_RAW_LOW; }

static inline void hal_output_write(const struct hal_output *output, bool level) {
  if (level)
    SIO_OUT_SET = output->mask;
  else
    SIO_OUT_CLR = output->mask;
}
