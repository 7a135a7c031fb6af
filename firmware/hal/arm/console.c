#include "console.h"

#include "cortex.h"
#include "hal.h"
#include "layer.h"

#define ROOM 255

// Rings of 256 bytes; the interrupt writes received_end and sent_begin, the foreground the others.
static volatile uint8_t received[256], sent[256];
static volatile uint8_t received_begin, received_end, sent_begin, sent_end;

void console_start(void) {
  received_begin = received_end = sent_begin = sent_end = 0;
  uart_start();
}

void console_interrupt(void) {
  uint8_t byte;
  while (uart_take(&byte)) {
    received[received_end] = byte;
    ++received_end;
  }
  while (sent_begin != sent_end && uart_ready()) {
    uart_give(sent[sent_begin]);
    ++sent_begin;
  }
  if (sent_begin == sent_end) uart_ask(false);
}

int16_t hal_console_read(void) {
  if (received_begin == received_end) return -1;
  uint8_t byte = received[received_begin];
  ++received_begin;
  return byte;
}

uint8_t hal_console_room(void) { return (uint8_t)(ROOM - (uint8_t)(sent_end - sent_begin)); }

void hal_console_write(const uint8_t *data, uint8_t size) {
  uint8_t end = sent_end;
  while (size--) sent[end++] = *data++;
  hal_irq_t irq = hal_irq_save();
  sent_end = end;
  uart_ask(true);
  // Some UARTs interrupt only when space becomes free, not while there is space.
  NVIC_ISPR(CHIP_UART_IRQ) = 1u << CHIP_UART_IRQ % 32;
  hal_irq_restore(irq);
}
