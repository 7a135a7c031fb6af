// SAM3X8E (data sheet 11057): addresses of what the layer uses, and the chip's figures.
#pragma once
#include <stdint.h>

#include "cortex.h"

#define CHIP_CORE_HZ 84000000UL
#define CHIP_UART_IRQ 8
#define CHIP_IRQS 45

#define HAL_ARENA 49152
#define HAL_SHORTEST_PERIOD 420  // 10 µs
#define HAL_ANALOG_WAIT 1050     // 25 µs: one conversion, and a little
#define HAL_PWM_MAX 255

struct hal_output {
  volatile uint32_t *port;
  uint32_t mask;
};
struct hal_input {
  volatile uint32_t *port;
  uint32_t mask;
};
struct hal_analog {
  uint8_t channel;
};
struct hal_pwm {
  volatile uint32_t *duty;
};

// Parallel ports, by words from the port's base.
#define PIO(port) ((volatile uint32_t *)(0x400E0E00 + 0x200 * (port)))
#define PIO_PER 0
#define PIO_PDR 1
#define PIO_OER 4
#define PIO_ODR 5
#define PIO_SODR 12
#define PIO_CODR 13
#define PIO_PDSR 15
#define PIO_PUDR 24
#define PIO_PUER 25
#define PIO_ABSR 28

// Power management: clocks of the modules by their numbers.
#define PMC_PCER0 REG(0x400E0610)
#define PMC_PCER1 REG(0x400E0700)
#define CKGR_MOR REG(0x400E0620)
#define CKGR_PLLAR REG(0x400E0628)
#define PMC_MCKR REG(0x400E0630)
#define PMC_SR REG(0x400E0668)
#define ID_UART 8
#define ID_PIOA 11
#define ID_TC0 27
#define ID_PWM 36
#define ID_ADC 37

#define EEFC0_FMR REG(0x400E0A00)
#define EEFC1_FMR REG(0x400E0C00)
#define RSTC_CR REG(0x400E1A00)
#define WDT_MR REG(0x400E1A54)

#define TC0_CCR REG(0x40080000)
#define TC0_CMR REG(0x40080004)
#define TC0_CV REG(0x40080010)

#define UART_CR REG(0x400E0800)
#define UART_MR REG(0x400E0804)
#define UART_IER REG(0x400E0808)
#define UART_IDR REG(0x400E080C)
#define UART_SR REG(0x400E0814)
#define UART_RHR REG(0x400E0818)
#define UART_THR REG(0x400E081C)
#define UART_BRGR REG(0x400E0820)
#define UART_RXRDY 1u
#define UART_TXRDY 2u

#define ADC_CR REG(0x400C0000)
#define ADC_MR REG(0x400C0004)
#define ADC_CHER REG(0x400C0010)
#define ADC_CHDR REG(0x400C0014)
#define ADC_LCDR REG(0x400C0020)
#define ADC_ISR REG(0x400C0030)
#define ADC_DRDY (1u << 24)

#define PWM_ENA REG(0x40094004)
#define PWM_SR REG(0x4009400C)
#define PWM_CHANNEL(n) ((volatile uint32_t *)(0x40094200 + 0x20 * (n)))
#define PWM_CMR 0
#define PWM_CDTY 1
#define PWM_CDTYUPD 2
#define PWM_CPRD 3

static inline uint32_t chip_clock(void) { return TC0_CV; }
