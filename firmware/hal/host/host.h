// What a program sees of the firmware when it is a library: one board for each copy that is loaded,
// in virtual time. Clocks are 64 bits wide and never run backwards.
#pragma once
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

// The board's surroundings. All are called with `owner`, from the functions below.
struct host_surroundings {
  void *owner;
  // A pin changes its level at `clock`, which is not before now. Calls come in the order of their
  // clocks; only the end of a step pulse is reported together with its start.
  void (*edge)(void *owner, uint16_t pin, bool level, int64_t clock);
  // An output takes a value; `full` means fully on.
  void (*output)(void *owner, uint16_t pin, uint32_t value, uint32_t full, int64_t clock);
  bool (*level)(void *owner, uint16_t pin, int64_t clock);
  uint16_t (*analog)(void *owner, uint16_t pin, int64_t clock);
  // A chain of lights receives `size` bytes; false: a bit was late.
  bool (*lights)(void *owner, uint16_t pin, const uint8_t *data, uint16_t size, int64_t clock);
};
struct host_options {
  uint32_t clock_hz;
  uint16_t moves_max;
  const uint8_t *dictionary;  // compressed; not copied
  uint16_t dictionary_size;
  int64_t start;  // clock at power-on
};

struct host_state {
  uint8_t reason;         // number of the shutdown's reason, or 0
  uint32_t frames, naks;  // since the last reset
};

struct host_functions {
  // Powers the board on.
  void (*start)(const struct host_options *options, const struct host_surroundings *surroundings);
  // Runs to `now`, then takes the received bytes.
  void (*feed)(const uint8_t *data, size_t size, int64_t now);
  // Does everything that is due until `now`.
  void (*run)(int64_t now);
  // Returns the clock of the board's next observable action, without steps. INT64_MAX: there is
  // none.
  int64_t (*next)(void);
  // The messages of the board: `size` bytes, valid until the next call of any of these.
  const uint8_t *(*take)(size_t *size);
  struct host_state (*state)(void);
  // The dictionary that the build made, without pins and clock.
  const uint8_t *(*built_dictionary)(size_t *size);
};
__attribute__((visibility("default"))) const struct host_functions *passo_firmware(void);

#ifdef __cplusplus
}
#endif
