#include "frame.h"

#include <string.h>

#include "codec.h"
#include "declare.h"
#include "hal.h"

#define SEQUENCE_MARK 0x10
#define SEQUENCE_MASK 0x0f

struct frame_counts frame_counts;

static uint8_t received[FRAME_MAX];
static uint8_t size;   // bytes in `received`, without a complete frame
static bool skipping;  // up to the next sync
static uint8_t sequence;

DECL_START(frame_start);
void frame_start(void) {
  size = 0;
  skipping = false;
  sequence = 0;
  memset(&frame_counts, 0, sizeof frame_counts);
}

static uint16_t checksum(const uint8_t *data, uint8_t n) {
  uint16_t crc = 0xffff;
  while (n--) crc = hal_crc16(crc, *data++);
  return crc;
}

bool frame_send(uint8_t *frame, uint8_t *end) {
  uint8_t length = (uint8_t)(end - frame + FRAME_TRAILER);
  if (hal_console_room() < length) return false;
  frame[0] = length;
  frame[1] = SEQUENCE_MARK | sequence;
  uint16_t crc = checksum(frame, (uint8_t)(length - FRAME_TRAILER));
  end[0] = (uint8_t)(crc >> 8);
  end[1] = (uint8_t)crc;
  end[2] = FRAME_SYNC;
  hal_console_write(frame, length);
  return true;
}

static void acknowledge(void) {
  uint8_t frame[FRAME_MIN];
  frame_send(frame, frame + FRAME_HEADER);
}

// Drops bytes that do not belong to a frame, up to the next sync.
static void skip(void) {
  const uint8_t *sync = memchr(received, FRAME_SYNC, size);
  skipping = sync == NULL;
  uint8_t used = skipping ? size : (uint8_t)(sync - received + 1);
  size -= used;
  memmove(received, received + used, size);
}

static void refuse(void) {
  ++frame_counts.naks;
  skip();
  acknowledge();
}

static bool complete(void) {
  uint8_t length = received[0];
  const uint8_t *trailer = received + length - FRAME_TRAILER;
  uint16_t crc = checksum(received, (uint8_t)(length - FRAME_TRAILER));
  return trailer[2] == FRAME_SYNC && trailer[0] == (uint8_t)(crc >> 8) &&
         trailer[1] == (uint8_t)crc;
}

// Checks the received bytes; returns true if they contain a complete frame, good or bad.
static bool examine(void (*execute)(const uint8_t *payload, const uint8_t *end)) {
  while (size > 0 && received[0] == FRAME_SYNC) {
    --size;
    memmove(received, received + 1, size);
  }
  if (size == 0) return false;
  uint8_t length = received[0];
  if (length < FRAME_MIN || length > FRAME_MAX ||
      (size > 1 && (received[1] & ~SEQUENCE_MASK) != SEQUENCE_MARK)) {
    refuse();
    return true;
  }
  if (size < length) return false;
  if (!complete()) {
    refuse();
    return true;
  }
  if ((received[1] & SEQUENCE_MASK) == sequence) {
    sequence = (sequence + 1) & SEQUENCE_MASK;
    ++frame_counts.frames;
    execute(received + FRAME_HEADER, received + length - FRAME_TRAILER);
  } else {
    ++frame_counts.naks;
  }
  size -= length;
  memmove(received, received + length, size);
  acknowledge();
  return true;
}

bool frame_task(void (*execute)(const uint8_t *payload, const uint8_t *end)) {
  // The bytes after a bad frame may contain another frame.
  if (hal_console_room() < FRAME_MAX) return false;
  if (size > 0 && examine(execute)) return true;
  int16_t byte;
  while ((byte = hal_console_read()) >= 0) {
    if (skipping) {
      skipping = byte != FRAME_SYNC;
      continue;
    }
    received[size++] = (uint8_t)byte;
    // Only these bytes can end a frame or make it bad.
    if ((size <= 2 || size == received[0]) && examine(execute)) return true;
  }
  return false;
}
