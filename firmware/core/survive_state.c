#include "survive_state.h"

#include "declare.h"
#include "hal.h"
#include "scheduler.h"

struct survive survive;

DECL_START(survive_start);
void survive_start(void) {
  survive.state = SURVIVE_OFF;
  survive.report_pending = survive.missed = false;
}

bool survive_stages(void) {
  return survive.state == SURVIVE_RESTING || survive.state == SURVIVE_MOVING;
}

bool survive_refuses(void) { return survive.state >= SURVIVE_BRAKING; }

bool survive_is_on(void) { return survive.state != SURVIVE_OFF; }

uint32_t survive_in_time(uint32_t clock) {
  uint32_t now = hal_clock();
  return survive_is_on() && before(clock, now) ? now + HAL_SHORTEST_PERIOD : clock;
}

bool survive_is_homing(void) { return survive.state == SURVIVE_HOMING; }

void survive_lose(void) {
  survive.state = SURVIVE_LOST;
  survive.report_pending = true;
}

void survive_miss(void) { survive.missed = true; }
