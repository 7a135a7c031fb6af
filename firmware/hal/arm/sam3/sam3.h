// SAM3X and SAM3U: common registers. registers.h of each chip has the addresses of the modules.
#pragma once
#include <stdbool.h>
#include <stdint.h>

#define CHIP_UART_IRQ ID_UART

#define HAL_SHORTEST_PERIOD (HAL_CLOCK_HZ / 100000)  // 10 µs
#define HAL_ANALOG_WAIT (HAL_CLOCK_HZ / 40000)       // 25 µs: one conversion and a margin

struct hal_output {
  volatile uint32_t *port;
  uint32_t mask;
};
struct hal_input {
  volatile uint32_t *port;
  uint32_t mask;
};
struct hal_pwm {
  volatile uint32_t *duty;
};

// Parallel ports: offsets in words from the port's base.
#define PIO(port) ((volatile uint32_t *)(PIO_BASE + 0x200 * (port)))
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

// Power management.
#define PMC_PCER(id) REG(PMC_BASE + ((id) < 32 ? 0x10 : 0x100))
#define CKGR_MOR REG(PMC_BASE + 0x20)
#define CKGR_PLLAR REG(PMC_BASE + 0x28)
#define PMC_MCKR REG(PMC_BASE + 0x30)
#define PMC_SR REG(PMC_BASE + 0x68)

#define EEFC0_FMR REG(EEFC_BASE)
#define EEFC1_FMR REG(EEFC_BASE + 0x200)
#define RSTC_CR REG(RSTC_BASE)
#define WDT_CR REG(WDT_BASE)
#define WDT_MR REG(WDT_BASE + 4)

#define UART_CR REG(UART_BASE + 0x00)
#define UART_MR REG(UART_BASE + 0x04)
#define UART_IER REG(UART_BASE + 0x08)
#define UART_IDR REG(UART_BASE + 0x0C)
#define UART_SR REG(UART_BASE + 0x14)
#define UART_RHR REG(UART_BASE + 0x18)
#define UART_THR REG(UART_BASE + 0x1C)
#define UART_BRGR REG(UART_BASE + 0x20)
#define UART_RXRDY 1u
#define UART_TXRDY 2u

#define ADC_CR REG(ADC_BASE + 0x00)
#define ADC_MR REG(ADC_BASE + 0x04)
#define ADC_CHER REG(ADC_BASE + 0x10)
#define ADC_CHDR REG(ADC_BASE + 0x14)
#define ADC_LCDR REG(ADC_BASE + 0x20)
#define ADC12B_ACR REG(ADC_BASE + 0x64)  // SAM3U

#define PWM_ENA REG(PWM_BASE + 0x04)
#define PWM_SR REG(PWM_BASE + 0x0C)
#define PWM_CHANNEL(n) ((volatile uint32_t *)(PWM_BASE + 0x200 + 0x20 * (n)))
#define PWM_CMR 0
#define PWM_CDTY 1
#define PWM_CDTYUPD 2
#define PWM_CPRD 3

static inline void hal_output_write(const struct hal_output *output, bool level) {
  output->port[level ? PIO_SODR : PIO_CODR] = output->mask;
}
