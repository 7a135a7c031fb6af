// Frames: length (5…64, all of it) | 0x10 + number | payload | CRC high, low | 0x7e.
//
// The host numbers its frames modulo 16. A good one with the number expected is executed and
// acknowledged with the next number; any other frame, and each stretch of bytes that is none, is
// answered with the number still expected. A frame is executed only when the console has room for
// the answers of one command and the acknowledgement. Foreground only.
#pragma once
#include <stdbool.h>
#include <stdint.h>

#define FRAME_MIN 5
#define FRAME_MAX 64
#define FRAME_HEADER 2
#define FRAME_TRAILER 3
#define FRAME_SYNC 0x7e

// Number of bytes and frames since the start.
struct frame_counts {
  uint32_t frames, naks, dropped;  // executed; refused; answers dropped by a full console
};
extern struct frame_counts frame_counts;

// Takes at most one frame from the received bytes, and passes its payload to `execute`. Returns
// false if there was nothing to do.
bool frame_task(void (*execute)(const uint8_t *payload, const uint8_t *end));
// Completes and sends the frame whose payload ends at `end`, with FRAME_HEADER bytes free in front
// and FRAME_TRAILER after it. False if the console has no space.
bool frame_send(uint8_t *frame, uint8_t *end);
