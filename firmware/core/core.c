#include "core.h"

#include "analog_in.h"
#include "buttons.h"
#include "control.h"
#include "frame.h"
#include "hal.h"
#include "object.h"
#include "scheduler.h"
#include "shutdown.h"
#include "spi.h"
#include "stepper.h"
#include "survive.h"
#include "thermocouple.h"
#include "tmcuart.h"
#include "trsync.h"

void core_start(uint32_t clock_high) {
  shutdown_start();
  scheduler_start();
  objects_start();
  steppers_start();
  survive_start();
  frame_start();
  control_start(clock_high);
}

bool core_task(void) {
  uint32_t began = hal_clock();
  bool busy = frame_task();
  survive_task();  // nothing may delay a brake
  if (task_woken()) {
    busy = true;
    spi_send_last();
    trsync_task();
    analog_in_task();
    buttons_task();
    tmcuart_task();
    thermocouple_task();
    shutdown_task();
  }
  control_task(began, busy);
  return busy;
}
