#include "neopixel.h"

#include <string.h>

#include "command.h"
#include "scheduler.h"
#include "shutdown.h"
#include "wait.h"

DECL_SHUTDOWN_REASON(NEOPIXEL_SIZE, "Invalid neopixel data_size");
DECL_SHUTDOWN_REASON(NEOPIXEL_PIN, "Not a valid neopixel pin");
DECL_SHUTDOWN_REASON(NEOPIXEL_UPDATE, "Invalid neopixel update command");
DECL_REPORT("neopixel_result oid=%c success=%c");

#define CONSOLE_EMPTY 255
#define LAST_BYTE (HAL_CLOCK_HZ / 10000)  // until the console is quiet: 100 us
#define WAIT_MAX (HAL_CLOCK_HZ / 50)      // for the console: 20 ms
#define TICKS_MAX 0x7fff                  // of HAL_WAIT(), and of a bit

static const struct object_kind kind = {OBJECT_NEOPIXEL, NULL};

DECL_COMMAND(command_config_neopixel,
             "config_neopixel oid=%c pin=%u data_size=%hu bit_max_ticks=%u reset_min_ticks=%u", 0);
void command_config_neopixel(const uint32_t *args) {
  if (args[2] > NEOPIXEL_MAX) {
    shut_down(SHUTDOWN_NEOPIXEL_SIZE);
    return;
  }
  struct neopixel *chain = object_add(args[0], &kind, sizeof *chain + args[2]);
  if (chain == NULL) return;
  chain->size = (uint16_t)args[2];
  chain->bit_max_ticks = (uint16_t)(args[3] > TICKS_MAX ? TICKS_MAX : args[3]);
  chain->reset_min_ticks = (uint16_t)(args[4] > TICKS_MAX ? TICKS_MAX : args[4]);
  chain->last = hal_clock();
  if (args[1] > 0xffff || !hal_output_setup(&chain->output, (uint16_t)args[1], false))
    shut_down(SHUTDOWN_NEOPIXEL_PIN);
}

DECL_COMMAND(command_neopixel_update, "neopixel_update oid=%c pos=%hu data=%*s", 0);
void command_neopixel_update(const uint32_t *args) {
  struct neopixel *chain = object_get(args[0], OBJECT_NEOPIXEL);
  if (chain == NULL) return;
  if (args[1] + args[2] > chain->size)
    shut_down(SHUTDOWN_NEOPIXEL_UPDATE);
  else
    memcpy(chain->data + args[1], command_bytes(), args[2]);
}

DECL_COMMAND(command_neopixel_send, "neopixel_send oid=%c", 0);
void command_neopixel_send(const uint32_t *args) {
  struct neopixel *chain = object_get(args[0], OBJECT_NEOPIXEL);
  if (chain == NULL) return;
  chain->due = true;
  chain->asked = hal_clock();
  task_wake();
}

static bool send(struct neopixel *chain) {
  uint32_t rested = hal_clock() - chain->last;
  HAL_WAIT(LAST_BYTE);
  if (rested < chain->reset_min_ticks) HAL_WAIT((uint16_t)(chain->reset_min_ticks - rested));
  bool sent = hal_lights_send(&chain->output, chain->data, chain->size, chain->bit_max_ticks);
  chain->last = hal_clock();
  return sent;
}

// A byte of the console between two bits makes the second one late on a slow chip. So a frame waits
// until the console has sent everything, but not for ever.
DECL_TASK(neopixel_task, BUSES);
void neopixel_task(void) {
  struct neopixel *chain;
  for (int16_t oid = -1; (chain = object_next(&oid, OBJECT_NEOPIXEL)) != NULL;) {
    if (!chain->due) continue;
    if (hal_console_room() != CONSOLE_EMPTY && hal_clock() - chain->asked < WAIT_MAX) {
      task_wake();
      return;
    }
    chain->due = false;
    report(REPORT_NEOPIXEL_RESULT, (uint32_t[]){(uint8_t)oid, send(chain)}, 2);
  }
}
