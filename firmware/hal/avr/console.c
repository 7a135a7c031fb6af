#include "console.h"

#include "hal.h"

#define DIVISOR ((BOARD_CLOCK_HZ + 4UL * BOARD_BAUD) / (8UL * BOARD_BAUD))
#define MADE (BOARD_CLOCK_HZ / 8UL / DIVISOR)
_Static_assert(MADE > BOARD_BAUD - BOARD_BAUD / 40 && MADE < BOARD_BAUD + BOARD_BAUD / 40,
               "the clock does not give this baud rate within 2.5 %");

#define ROOM 255

// Rings of 256 bytes; the interrupts write received_end and sent_begin, the foreground the others.
uint8_t received[256] __attribute__((aligned(256)));
uint8_t sent[256] __attribute__((aligned(256)));
volatile uint8_t received_end, sent_begin, sent_end;
static uint8_t received_begin;

void console_start(void) {
  received_begin = received_end = sent_begin = sent_end = 0;
  UCSR0A = 1 << U2X0;
  UBRR0 = DIVISOR - 1;
  UCSR0C = 1 << UCSZ01 | 1 << UCSZ00;
  UCSR0B = CONSOLE_QUIET;
}

int16_t hal_console_read(void) {
  return received_begin == received_end ? -1 : received[received_begin++];
}

uint8_t hal_console_room(void) { return (uint8_t)(ROOM - (uint8_t)(sent_end - sent_begin)); }

void hal_console_write(const uint8_t *data, uint8_t size) {
  uint8_t end = sent_end;
  while (size--) sent[end++] = *data++;
  hal_irq_t irq = hal_irq_save();
  sent_end = end;
  UCSR0B = CONSOLE_SENDING;
  hal_irq_restore(irq);
}
