// Chains of lights on one data pin, with the timing of the WS2812.
#pragma once
#include <stdbool.h>
#include <stdint.h>

#include "object.h"

#define NEOPIXEL_MAX 500  // bytes of a chain

struct neopixel {
  struct object object;
  struct hal_output output;
  uint16_t size, bit_max_ticks;
  uint16_t reset_min_ticks;  // rest of the line before a frame
  uint32_t last;             // clock of the end of the last frame
  uint32_t asked;            // when the frame was asked for
  bool due;
  uint8_t data[];
};
