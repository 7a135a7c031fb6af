#include "hal.h"
#include "layer.h"

#define DIVISOR ((CHIP_CORE_HZ + 8UL * BOARD_BAUD) / (16UL * BOARD_BAUD))
#define MADE (CHIP_CORE_HZ / 16UL / DIVISOR)
_Static_assert(MADE > BOARD_BAUD - BOARD_BAUD / 40 && MADE < BOARD_BAUD + BOARD_BAUD / 40,
               "the clock does not give this baud rate within 2.5 %");

void uart_start(void) {
  PIO(0)[PIO_PDR] = UART_PINS;  // peripheral A of the pins
  PIO(0)[PIO_PUER] = UART_RECEIVE_PIN;
  UART_BRGR = DIVISOR;
  UART_MR = 4u << 9;  // no parity
  UART_CR = 1u << 4 | 1u << 6;
  UART_IER = UART_RXRDY;
}

bool uart_take(uint8_t *byte) {
  if (!(UART_SR & UART_RXRDY)) return false;
  *byte = (uint8_t)UART_RHR;
  return true;
}

bool uart_ready(void) { return UART_SR & UART_TXRDY; }
void uart_give(uint8_t byte) { UART_THR = byte; }

void uart_ask(bool ready) {
  if (ready)
    UART_IER = UART_TXRDY;
  else
    UART_IDR = UART_TXRDY;
}
