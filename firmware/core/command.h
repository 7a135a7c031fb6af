// Commands: their table, their arguments, and the answers.
#pragma once
#include <stdint.h>

#include "declare.h"
#include "declared.h"  // made by the build: REPORT_…, SHUTDOWN_…, COMMAND_COUNT
#include "hal.h"

#define ARGUMENTS_MAX 12

// Encoding and range of a value; two bits for each parameter. A signed 16-bit parameter is read as
// a long; its handler truncates it.
enum { TYPE_LONG, TYPE_WORD, TYPE_BYTE, TYPE_BYTES };

// A row of the table that the build makes: commands[id - COMMAND_FIRST].
struct command {
  void (*run)(const uint32_t *args);
  uint32_t types;  // the first parameter in the lowest bits
  uint8_t parameters, flags;
};
extern const struct command HAL_CONST commands[COMMAND_COUNT];

// The data dictionary, compressed with zlib.
extern const uint8_t HAL_CONST dictionary[];
extern const uint16_t dictionary_size;
#ifndef HAL_DICTIONARY
#define HAL_DICTIONARY dictionary
#define HAL_DICTIONARY_SIZE dictionary_size
#endif

// Executes the commands of one payload; a malformed one shuts down. Foreground.
void command_run(const uint8_t *payload, const uint8_t *end);
// The bytes of the current command's byte parameter n; args[n] is their number.
const uint8_t *command_bytes(void);

// Sends a report of `count` values, at most ARGUMENTS_MAX. False if the console has no space. The
// second form appends as many bytes as fit in a frame. Foreground.
bool report(uint8_t id, const uint32_t *values, uint8_t count);
bool report_bytes(uint8_t id, const uint32_t *values, uint8_t count, const uint8_t *bytes,
                  uint8_t size);
