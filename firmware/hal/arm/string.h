// The functions of the standard's <string.h> that the core uses; some compilers have none.
#pragma once
#include <stddef.h>

void *memchr(const void *in, int value, size_t size);
void *memcpy(void *restrict to, const void *restrict from, size_t size);
void *memmove(void *to, const void *from, size_t size);
void *memset(void *to, int value, size_t size);
