#include "hal.h"
#include "layer.h"
#include "pins.h"

#define DIVISOR ((4 * CHIP_CORE_HZ + BOARD_BAUD / 2) / BOARD_BAUD)  // in 64ths of 16 times the rate
#define MADE (4 * CHIP_CORE_HZ / DIVISOR)
_Static_assert(MADE > BOARD_BAUD - BOARD_BAUD / 40 && MADE < BOARD_BAUD + BOARD_BAUD / 40,
               "the clock does not give this baud rate within 2.5 %");

#define FR_EMPTY (1u << 4)
#define FR_FULL (1u << 5)
#define RECEIVED (1u << 4 | 1u << 6)  // interrupt after some bytes, or after one byte and silence
#define ROOM (1u << 5)

void uart_start(void) {
  pin_set(BOARD_SEND, FUNCTION_UART, PAD_INPUT | PAD_4_MA | PAD_SCHMITT);
  pin_set(BOARD_RECEIVE, FUNCTION_UART, PAD_INPUT | PAD_4_MA | PAD_SCHMITT | PAD_PULL_UP);
  UART_IBRD = DIVISOR / 64;
  UART_FBRD = DIVISOR % 64;
  UART_LCR_H = 3u << 5 | 1u << 4;  // 8 bits, queues of 32 bytes; applies the divisor, too
  UART_IFLS = 0;                   // interrupts with an eighth in a queue
  UART_IMSC = RECEIVED;
  UART_CR = 1u << 9 | 1u << 8 | 1u;
}

bool uart_take(uint8_t *byte) {
  if (UART_FR & FR_EMPTY) return false;
  *byte = (uint8_t)UART_DR;
  return true;
}

bool uart_ready(void) { return !(UART_FR & FR_FULL); }
void uart_give(uint8_t byte) { UART_DR = byte; }
void uart_ask(bool ready) { UART_IMSC = ready ? RECEIVED | ROOM : RECEIVED; }
