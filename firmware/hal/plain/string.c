#include <stdint.h>
#include <string.h>

void *memchr(const void *in, int value, size_t size) {
  for (const uint8_t *at = in; size--; ++at)
    if (*at == (uint8_t)value) return (void *)at;
  return NULL;
}

void *memcpy(void *restrict to, const void *restrict from, size_t size) {
  uint8_t *at = to;
  const uint8_t *source = from;
  while (size--) *at++ = *source++;
  return to;
}

void *memmove(void *to, const void *from, size_t size) {
  uint8_t *at = to;
  const uint8_t *source = from;
  if (at < source) {
    while (size--) *at++ = *source++;
    return to;
  }
  while (size--) at[size] = source[size];
  return to;
}

void *memset(void *to, int value, size_t size) {
  uint8_t *at = to;
  while (size--) *at++ = (uint8_t)value;
  return to;
}
