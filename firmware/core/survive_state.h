// Survive: what the board does if its host sends nothing during a print. It stops the motors on
// their path, with moves that the host has sent for this case (tails), and keeps heaters warm for a
// while. The host must switch this on (docs/decisions/0013-survive.md).
//
// This file has the state, which the modules of motors, outputs and inputs read. survive.c uses
// these modules; it has the host's commands and the decision to brake.
//
//   state    event → next state
//   all      survive_arm → RESTING; survive_home → HOMING; survive_off, a shutdown → OFF
//   HOMING   a step comes too late → LOST
//   RESTING  a commit that ends in motion → MOVING; a commit that comes too late → BRAKING
//   MOVING   a commit that ends at standstill → RESTING; no commit in time → BRAKING
//   BRAKING  the motors have stopped → HELD
#pragma once
#include <stdbool.h>
#include <stdint.h>

enum {
  SURVIVE_OFF,
  SURVIVE_HOMING,   // endstops stop the motors; there are no commits
  SURVIVE_RESTING,  // the last commit ends at standstill
  SURVIVE_MOVING,   // the next commit must come in time
  SURVIVE_BRAKING,
  SURVIVE_HELD,
  SURVIVE_LOST,  // a step came too late during homing: the motors stopped at unknown positions
};

// Written by the foreground. While the state is SURVIVE_MOVING, the timer of the decision writes it
// too; then the foreground needs hal_irq_save().
extern struct survive {
  volatile uint8_t state;
  volatile bool report_pending;  // the host must get a report of the state
  bool missed;                   // see survive_miss(); written by the foreground
} survive;

// Returns whether moves wait for their commit. Foreground.
bool survive_stages(void);
// Returns whether moves are refused, because the board brakes or has stopped. Foreground.
bool survive_refuses(void);
// Returns whether survive is on. If not, the board shuts down when the host is missing. Any
// context.
bool survive_is_on(void);
// Returns `clock`. If survive is on and `clock` is in the past, returns a clock that is as near as
// possible, so that a late message does not shut the board down. Any context.
uint32_t survive_in_time(uint32_t clock);
// Returns whether axes are being homed. Foreground.
bool survive_is_homing(void);
// A step came too late during homing, and all motors have stopped. Foreground.
void survive_lose(void);
// A message of the next commit came too late, so the commit will be refused. Foreground.
void survive_miss(void);
