#include "tmcuart.h"

#include <stddef.h>
#include <string.h>

#include "command.h"
#include "shutdown.h"

DECL_SHUTDOWN_REASON(TMCUART_TOO_LONG, "tmcuart data too large");
DECL_SHUTDOWN_REASON(TMCUART_PINS, "Pins cannot make a driver's UART");
DECL_REPORT("tmcuart_response oid=%c read=%*s");

#define REST_US 200      // minimum time that the line is high before a datagram
#define TURN_BITS 4      // from the end of a datagram until the answer is sampled
#define LOOKS_A_BIT 4    // samples a bit while waiting for the start bit
#define TIMEOUT_BITS 64  // time without a start bit that ends the wait
#define SYNC_EDGES 5  // start bit and 1010: four bits between the first and the last falling edge
#define BEGINS_WITH_SYNC(byte) (((byte) & 0x3f) == 0x2a)

static struct tmcuart *of(struct timer *timer) {
  return (struct tmcuart *)((char *)timer - offsetof(struct tmcuart, timer));
}

// Sets the level and reads the clock without interrupts: a step between the two would make the edge
// look late. Returns the clock of the edge.
static uint32_t drive(struct tmcuart *uart, bool level) {
  uart->level = level;
  hal_irq_t irq = hal_irq_save();
  hal_output_write(&uart->to_driver, level);
  uint32_t clock = hal_clock();
  hal_irq_restore(irq);
  return clock;
}

static void rest(struct tmcuart *uart) {
  if (uart->one_wire)
    hal_output_setup(&uart->to_driver, uart->pin, true);
  else
    hal_output_write(&uart->to_driver, true);
  uart->level = true;
}

static bool finish(struct tmcuart *uart) {
  rest(uart);
  uart->answered = true;
  task_wake();
  return false;
}

static bool read_bit(struct timer *timer) {
  struct tmcuart *uart = of(timer);
  uint8_t mask = (uint8_t)(1 << (uart->bit & 7)), *byte = &uart->bits[uart->bit >> 3];
  *byte = (uint8_t)(hal_input_read(&uart->from_driver) ? *byte | mask : *byte & ~mask);
  if (++uart->bit == uart->read_bits) return finish(uart);
  timer->wake += uart->bit_ticks;
  return true;
}

// Waits for the start bit of the answer.
static bool look(struct timer *timer) {
  struct tmcuart *uart = of(timer);
  bool high = hal_input_read(&uart->from_driver);
  timer->wake += uart->bit_ticks / LOOKS_A_BIT;
  if (!high && uart->was_high) {
    uart->bit = 0;
    timer->run = read_bit;  // the later samples are near the middle of each bit
    return true;
  }
  uart->was_high |= high;
  if (++uart->looks <= TIMEOUT_BITS * LOOKS_A_BIT) return true;
  uart->read_bits = 0;
  return finish(uart);
}

static bool turn_around(struct timer *timer) {
  struct tmcuart *uart = of(timer);
  if (uart->read_bits == 0) return finish(uart);
  if (uart->one_wire) hal_input_setup(&uart->from_driver, uart->pin, uart->pull_up);
  uart->looks = 0;
  uart->was_high = false;
  timer->run = look;
  timer->wake += uart->bit_ticks * TURN_BITS;
  return true;
}

// The driver measures the length of a bit in the sync nibble: all later bits must have the measured
// length, however late this timer runs.
static void keep_time(struct tmcuart *uart, uint32_t edge) {
  if (++uart->edges > SYNC_EDGES) return;
  uint32_t late = edge - uart->timer.wake;
  if (uart->edges == 1) uart->late = late;
  if (uart->edges < SYNC_EDGES) return;
  int32_t longer = (int32_t)(late - uart->late);
  uart->bit_ticks += (uint32_t)((longer + (longer < 0 ? -2 : 2)) / 4);
  uart->timer.wake += (uint32_t)longer;
}

static bool send_bits(struct timer *timer) {
  struct tmcuart *uart = of(timer);
  bool level = uart->bits[uart->bit >> 3] >> (uart->bit & 7) & 1;
  if (level != uart->level) keep_time(uart, drive(uart, level));
  do {
    timer->wake += uart->bit_ticks;
    if (++uart->bit == uart->send_bits) {
      timer->run = turn_around;
      break;
    }
  } while ((uart->bits[uart->bit >> 3] >> (uart->bit & 7) & 1) == uart->level);
  return true;
}

static void shut_down_uart(void *object) {
  struct tmcuart *uart = object;
  timer_remove(&uart->timer);
  rest(uart);
  uart->busy = uart->answered = false;
}
static const struct object_kind kind = {OBJECT_TMCUART, shut_down_uart};

DECL_TASK(tmcuart_task, INPUTS);
void tmcuart_task(void) {
  struct tmcuart *uart;
  for (int16_t oid = -1; (uart = object_next(&oid, OBJECT_TMCUART)) != NULL;) {
    if (!uart->answered) continue;
    // A report that does not fit counts as lost on the wire.
    report_bytes(REPORT_TMCUART_RESPONSE, (uint32_t[]){(uint8_t)oid}, 1, uart->bits,
                 uart->read_bits / 8);
    uart->busy = uart->answered = false;
  }
}

DECL_COMMAND(command_config_tmcuart,
             "config_tmcuart oid=%c rx_pin=%u pull_up=%c tx_pin=%u bit_time=%u", 0);
void command_config_tmcuart(const uint32_t *args) {
  struct tmcuart wanted = {.one_wire = args[1] == args[3],
                           .pin = (uint16_t)args[3],
                           .pull_up = args[2] != 0,
                           .level = true,
                           .nominal_ticks = args[4]};
  // At a shutdown all lines are released, also those whose pins are not set up yet.
  if (args[1] > 0xffff || args[3] > 0xffff || args[4] < HAL_SHORTEST_PERIOD ||
      !hal_input_setup(&wanted.from_driver, (uint16_t)args[1], wanted.pull_up) ||
      !hal_output_setup(&wanted.to_driver, (uint16_t)args[3], true)) {
    shut_down(SHUTDOWN_TMCUART_PINS);
    return;
  }
  hal_irq_t irq = hal_irq_save();
  struct tmcuart *uart = object_add(args[0], &kind, sizeof *uart);
  if (uart != NULL) {
    *uart = wanted;
    uart->object.kind = &kind;
  }
  hal_irq_restore(irq);
}

// Without an answer the report holds no bits. While the line is busy, the command has no effect.
DECL_COMMAND(command_tmcuart_send, "tmcuart_send oid=%c write=%*s read=%c", 0);
void command_tmcuart_send(const uint32_t *args) {
  struct tmcuart *uart = object_get(args[0], OBJECT_TMCUART);
  if (uart == NULL || uart->busy) return;
  if (args[1] > TMCUART_BYTES || args[2] > TMCUART_BYTES) {
    shut_down(SHUTDOWN_TMCUART_TOO_LONG);
    return;
  }
  memcpy(uart->bits, command_bytes(), args[1]);
  uart->send_bits = (uint8_t)(args[1] * 8);
  uart->read_bits = (uint8_t)(args[2] * 8);
  uart->bit = 0;
  uart->edges = args[1] > 0 && BEGINS_WITH_SYNC(uart->bits[0]) ? 0 : SYNC_EDGES;
  uart->bit_ticks = uart->nominal_ticks;
  uart->timer.run = args[1] > 0 ? send_bits : turn_around;
  hal_irq_t irq = hal_irq_save();
  if (!is_shut_down()) {
    uart->busy = true;
    uart->timer.wake = hal_clock() + (uint32_t)(HAL_CLOCK_HZ / 1000000 * REST_US);
    timer_add(&uart->timer);
  }
  hal_irq_restore(irq);
}
