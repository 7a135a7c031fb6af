#include "command.h"

#include <string.h>

#include "codec.h"
#include "frame.h"
#include "shutdown.h"

DECL_SHUTDOWN_REASON(BAD_COMMAND, "Command parser error");

static const uint8_t *bytes_at;

const uint8_t *command_bytes(void) { return bytes_at; }

// Reads the arguments of one command; returns false if they do not match its declaration.
static bool read_arguments(struct reader *in, const struct command *row, uint32_t *args) {
  uint32_t types = hal_const32(&row->types);
  for (uint8_t left = hal_const8(&row->parameters); left > 0; --left, types >>= 2, ++args) {
    switch (types & 3) {
      case TYPE_BYTES:
        if (in->at == in->end || in->end - in->at < *in->at + 1) return false;
        *args = *in->at++;
        bytes_at = in->at;
        in->at += *args;
        continue;
      case TYPE_BYTE:
        *args = read_vlq(in);
        if (*args > 0xff) return false;
        break;
      case TYPE_WORD:
        *args = read_vlq(in);
        if (*args > 0xffff) return false;
        break;
      default:
        *args = read_vlq(in);
    }
    if (in->at == NULL) return false;
  }
  return true;
}

void command_run(const uint8_t *payload, const uint8_t *end) {
  struct reader in = {payload, end};
  while (in.at != in.end) {
    uint32_t args[ARGUMENTS_MAX];
    uint32_t index = read_vlq(&in) - COMMAND_FIRST;
    const struct command *row = index < COMMAND_COUNT ? &commands[index] : NULL;
    if (in.at == NULL || row == NULL || !read_arguments(&in, row, args)) {
      shut_down(SHUTDOWN_BAD_COMMAND);
      return;
    }
    if (is_shut_down() && !(hal_const8(&row->flags) & IN_SHUTDOWN)) {
      report(REPORT_IS_SHUTDOWN, (uint32_t[]){shutdown_reason()}, 1);
      continue;
    }
    void (*run)(const uint32_t *) = (void (*)(const uint32_t *))hal_const_pointer(&row->run);
    run(args);
  }
}

bool report_bytes(uint8_t id, const uint32_t *values, uint8_t count, const uint8_t *bytes,
                  uint8_t size) {
  uint8_t frame[FRAME_HEADER + VLQ_MAX * (ARGUMENTS_MAX + 1) + FRAME_MAX + FRAME_TRAILER];
  uint8_t *at = write_vlq(frame + FRAME_HEADER, id);
  while (count--) at = write_vlq(at, *values++);
  if (bytes) {
    uint8_t room = (uint8_t)(frame + FRAME_MAX - FRAME_TRAILER - 1 - at);
    if (size > room) size = room;
    *at++ = size;
    memcpy(at, bytes, size);
    at += size;
  }
  if (frame_send(frame, at)) return true;
  ++frame_counts.dropped;
  return false;
}

bool report(uint8_t id, const uint32_t *values, uint8_t count) {
  return report_bytes(id, values, count, NULL, 0);
}
