// STM32F405/407 and STM32F42x (reference manual RM0090): addresses of what the layer uses, and the
// chips' figures.
#pragma once
#include <stdbool.h>
#include <stdint.h>

#include "cortex.h"

#define CHIP_CORE_HZ 168000000UL
#define CHIP_CLOCK_HZ (CHIP_CORE_HZ / 2)
#define CHIP_APB1_HZ (CHIP_CORE_HZ / 4)
#define CHIP_APB2_HZ (CHIP_CORE_HZ / 2)
#define CHIP_IRQS 91  // of the STM32F42x; the others have 82

#define HAL_ARENA 49152
#define HAL_SHORTEST_PERIOD 840  // 10 µs
#define HAL_ANALOG_WAIT 2520     // 30 µs: one conversion and a margin

struct hal_output {
  volatile uint32_t *set_reset;
  uint32_t mask;
};
struct hal_input {
  volatile uint32_t *data;
  uint32_t mask;
};
struct hal_pwm {
  volatile uint32_t *compare;
  uint32_t top;
};

// Ports: offsets in words from the port's base.
#define GPIO(port) ((volatile uint32_t *)(0x40020000 + 0x400 * (port)))
#define GPIO_MODER 0
#define GPIO_PUPDR 3
#define GPIO_IDR 4
#define GPIO_BSRR 6
#define GPIO_AFR 8  // and 9

#define RCC_CR REG(0x40023800)
#define RCC_PLLCFGR REG(0x40023804)
#define RCC_CFGR REG(0x40023808)
#define RCC_AHB1RSTR REG(0x40023810)
#define RCC_APB1RSTR REG(0x40023820)
#define RCC_APB2RSTR REG(0x40023824)
#define RCC_AHB1ENR REG(0x40023830)
#define RCC_APB1ENR REG(0x40023840)
#define RCC_APB2ENR REG(0x40023844)
#define AHB1_PORTS 0xFFu    // A to H
#define APB1_TIMERS 0x1CFu  // TIM2 to TIM5, TIM12 to TIM14
#define APB1_TIM2 (1u << 0)
#define APB1_USARTS (3u << 17)  // USART2, USART3
#define APB2_TIMERS 0x70003u    // TIM1, TIM8, TIM9 to TIM11
#define APB2_USART1 (1u << 4)
#define APB2_ADCS (7u << 8)
#define APB2_ADC_RESET (1u << 8)  // of all three

#define FLASH_ACR REG(0x40023C00)

#define IWDG_KR REG(0x40003000)
#define IWDG_PR REG(0x40003004)
#define IWDG_RLR REG(0x40003008)

#define TIM2_CR1 REG(0x40000000)
#define TIM2_CNT REG(0x40000024)

#ifdef BOARD_UART_USART1
#define USART_BASE 0x40011000
#define USART_HZ CHIP_APB2_HZ
#define CHIP_UART_IRQ 37
#elif defined BOARD_UART_USART2
#define USART_BASE 0x40004400
#define USART_HZ CHIP_APB1_HZ
#define CHIP_UART_IRQ 38
#elif defined BOARD_UART_USART3
#define USART_BASE 0x40004800
#define USART_HZ CHIP_APB1_HZ
#define CHIP_UART_IRQ 39
#else
#error "no console on that UART"
#endif
#define USART_FUNCTION 7  // of the pins of all three
#define USART_SR REG(USART_BASE + 0x00)
#define USART_DR REG(USART_BASE + 0x04)
#define USART_BRR REG(USART_BASE + 0x08)
#define USART_CR1 REG(USART_BASE + 0x0C)

// Converters: offsets in words from the converter's base.
#define ADC1 ((volatile uint32_t *)0x40012000)
#define ADC3 ((volatile uint32_t *)0x40012200)
#define ADC_SR 0
#define ADC_CR2 2
#define ADC_SMPR1 3
#define ADC_SMPR2 4
#define ADC_SQR1 11
#define ADC_SQR3 13
#define ADC_DR 19
#define ADC_CCR REG(0x40012304)

// Timers: offsets in words from the timer's base.
#define TIM_CR1 0
#define TIM_EGR 5
#define TIM_CCMR 6  // and 7
#define TIM_CCER 8
#define TIM_PSC 10
#define TIM_ARR 11
#define TIM_CCR 13  // to 16
#define TIM_BDTR 17

static inline uint32_t chip_clock(void) { return TIM2_CNT; }

static inline void hal_output_write(const struct hal_output *output, bool level) {
  *output->set_reset = level ? output->mask : output->mask << 16;
}
