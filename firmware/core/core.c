#include "core.h"

#include "command.h"
#include "control.h"
#include "frame.h"
#include "hal.h"
#include "hooks.h"
#include "scheduler.h"

void core_start(uint32_t clock_high) {
  hooks_start();
  control_start(clock_high);
}

bool core_task(void) {
  uint32_t began = hal_clock();
  bool busy = frame_task(command_run);
  hooks_every_pass();
  if (task_woken()) {
    busy = true;
    hooks_task();
  }
  control_task(began, busy);
  return busy;
}
