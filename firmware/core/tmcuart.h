// The one-wire UART of motor drivers (TMC2208, TMC2209 and similar), by software. The host sends
// the bits of a datagram, with start and stop bits, and receives those of the answer.
#pragma once
#include <stdbool.h>
#include <stdint.h>

#include "hal.h"
#include "object.h"
#include "scheduler.h"

#define TMCUART_BYTES 10  // maximum bits in each direction: a datagram of eight bytes

struct tmcuart {
  struct object object;
  struct timer timer;
  struct hal_output to_driver;
  struct hal_input from_driver;
  uint16_t pin;  // one pin for both directions
  bool one_wire, pull_up;
  uint32_t nominal_ticks;  // ticks of one bit
  // Written by the timer while it is busy.
  uint32_t bit_ticks;
  uint32_t late;  // lateness of the first edge
  uint16_t looks;
  uint8_t bit, edges;
  uint8_t send_bits, read_bits;
  bool level, was_high;
  volatile bool busy, answered;
  uint8_t bits[TMCUART_BYTES];  // the lowest bit of each byte first
};
