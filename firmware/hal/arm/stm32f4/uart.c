#include "hal.h"
#include "layer.h"
#include "pins.h"

#define DIVISOR ((USART_HZ + BOARD_BAUD / 2) / BOARD_BAUD)  // in sixteenths of 16 times the rate
#define MADE (USART_HZ / DIVISOR)
_Static_assert(MADE > BOARD_BAUD - BOARD_BAUD / 40 && MADE < BOARD_BAUD + BOARD_BAUD / 40,
               "the clock does not give this baud rate within 2.5 %");

#define SR_OVERRUN (1u << 3)
#define SR_RECEIVED (1u << 5)
#define SR_READY (1u << 7)
#define CR1_ON (1u << 13 | 1u << 3 | 1u << 2 | 1u << 5)  // receive and send, receive interrupt
#define CR1_READY (1u << 7)

void uart_start(void) {
  pin_alternate(BOARD_RECEIVE, USART_FUNCTION);
  pin_alternate(BOARD_SEND, USART_FUNCTION);
  pin_set(BOARD_RECEIVE, PIN_ALTERNATE, true);
  USART_BRR = DIVISOR;
  USART_CR1 = CR1_ON;
}

// Reading status and then data clears both flags; an overrun interrupts, too.
bool uart_take(uint8_t *byte) {
  uint32_t status = USART_SR;
  if (!(status & (SR_RECEIVED | SR_OVERRUN))) return false;
  *byte = (uint8_t)USART_DR;
  return status & SR_RECEIVED;
}

bool uart_ready(void) { return USART_SR & SR_READY; }
void uart_give(uint8_t byte) { USART_DR = byte; }
void uart_ask(bool ready) { USART_CR1 = ready ? CR1_ON | CR1_READY : CR1_ON; }
