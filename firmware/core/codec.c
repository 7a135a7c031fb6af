#include "codec.h"

#include <stddef.h>

uint32_t read_vlq(struct reader *reader) {
  const uint8_t *at = reader->at, *end = reader->end;
  if (at == NULL || at == end) goto cut_short;
  uint8_t byte = *at++;
  // Most numbers take at most two bytes, so 8-bit chips calculate with 16 bits as long as possible.
  int16_t low = byte & 0x7f;
  if ((byte & 0x60) == 0x60) low |= ~0x1f;
  if (!(byte & 0x80)) {
    reader->at = at;
    return (uint32_t)(int32_t)low;
  }
  if (at == end) goto cut_short;
  byte = *at++;
  low = (int16_t)((uint16_t)low << 7 | (byte & 0x7f));
  uint32_t value = (uint32_t)(int32_t)low;
  for (uint8_t used = 2; byte & 0x80; ++used) {
    if (at == end || used == VLQ_MAX) goto cut_short;
    byte = *at++;
    value = value << 7 | (byte & 0x7f);
  }
  reader->at = at;
  return value;
cut_short:
  reader->at = NULL;
  return 0;
}

uint8_t *write_vlq(uint8_t *at, uint32_t value) {
  int32_t v = (int32_t)value;
  if (v >= 3L << 26 || v < -(1L << 26)) *at++ = (uint8_t)(value >> 28 | 0x80);
  if (v >= 3L << 19 || v < -(1L << 19)) *at++ = (uint8_t)((value >> 21 & 0x7f) | 0x80);
  if (v >= 3L << 12 || v < -(1L << 12)) *at++ = (uint8_t)((value >> 14 & 0x7f) | 0x80);
  if (v >= 3L << 5 || v < -(1L << 5)) *at++ = (uint8_t)((value >> 7 & 0x7f) | 0x80);
  *at++ = (uint8_t)(value & 0x7f);
  return at;
}
