// Numbers and checksums on the wire. A number of 32 bits takes one to five bytes, seven bits each,
// the high ones first; bit 7 says that more follow. A first byte with bits 6 and 5 both set begins
// a negative number.
#pragma once
#include <stdint.h>

#include "hal.h"

// Maximum size of a number in bytes.
#define VLQ_MAX 5

#ifndef hal_crc16
// One step of CRC-16/MCRF4XX, which starts from 0xffff.
static inline uint16_t hal_crc16(uint16_t crc, uint8_t byte) {
  byte ^= (uint8_t)crc;
  byte ^= (uint8_t)(byte << 4);
  return (uint16_t)((((uint16_t)byte << 8) | (crc >> 8)) ^ (uint8_t)(byte >> 4) ^
                    ((uint16_t)byte << 3));
}
#endif

// The source of values. `at` becomes null, and stays null, if a value is incomplete.
struct reader {
  const uint8_t *at, *end;
};

// The next number, or 0.
uint32_t read_vlq(struct reader *reader);
// Appends a number; returns the end.
uint8_t *write_vlq(uint8_t *at, uint32_t value);
