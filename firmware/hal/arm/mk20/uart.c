#include "hal.h"
#include "layer.h"

#define DIVISOR ((2 * CHIP_CORE_HZ + BOARD_BAUD / 2) / BOARD_BAUD)  // in 32nds of 16 times the rate
#define MADE (2 * CHIP_CORE_HZ / DIVISOR)
_Static_assert(MADE > BOARD_BAUD - BOARD_BAUD / 40 && MADE < BOARD_BAUD + BOARD_BAUD / 40,
               "the clock does not give this baud rate within 2.5 %");

#define S1_OVERRUN (1u << 3)
#define S1_RECEIVED (1u << 5)
#define S1_READY (1u << 7)
#define C2_ON (1u << 5 | 1u << 3 | 1u << 2)  // receive and send, with the receive interrupt
#define C2_READY (1u << 7)

void uart_start(void) {
  PORT_PCR(BOARD_RECEIVE) = PCR_FUNCTION(UART_FUNCTION) | PCR_PULL_UP;
  PORT_PCR(BOARD_SEND) = PCR_FUNCTION(UART_FUNCTION) | PCR_STRONG;
  UART_BDH = (uint8_t)(DIVISOR / 32 >> 8);
  UART_BDL = (uint8_t)(DIVISOR / 32);
  UART_C4 = DIVISOR % 32;
  UART_C2 = C2_ON;
}

// Reading status and then data clears the receive flag, and the overrun flag if the status had it.
// An overrun between the two reads stays set, and blocks reception until it is cleared.
bool uart_take(uint8_t *byte) {
  uint8_t status = UART_S1;
  if (!(status & (S1_RECEIVED | S1_OVERRUN))) return false;
  *byte = UART_D;
  return status & S1_RECEIVED;
}

bool uart_ready(void) { return UART_S1 & S1_READY; }
void uart_give(uint8_t byte) { UART_D = byte; }
void uart_ask(bool ready) { UART_C2 = ready ? C2_ON | C2_READY : C2_ON; }
