// The one-wire UART of motor drivers (TMC2208, TMC2209 and their like), by software: the host
// gives the bits of a datagram, start and stop bits included, and gets those of the answer.
#pragma once
#include <stdbool.h>
#include <stdint.h>

#include "hal.h"
#include "object.h"
#include "scheduler.h"

#define TMCUART_BYTES 10  // of bits, either way: a datagram of eight bytes

struct tmcuart {
  struct object object;
  struct timer timer;
  struct hal_output to_driver;
  struct hal_input from_driver;
  uint16_t pin;  // of one wire for both ways
  bool one_wire, pull_up;
  uint32_t nominal_ticks;  // of a bit
  // The timer's while it is busy.
  uint32_t bit_ticks;
  uint32_t late;  // by how much the first edge was
  uint16_t looks;
  uint8_t bit, edges;
  uint8_t send_bits, read_bits;
  bool level, was_high;
  volatile bool busy, answered;
  uint8_t bits[TMCUART_BYTES];  // the lowest of each byte first
};
