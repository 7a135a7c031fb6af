// What the board does when its host falls silent in the midst of a print: it stops the motors on
// their path, by moves that the host sent for that case (tails), and keeps heaters warm for a
// while. Only hosts that ask for it get it (docs/decisions/0013-survive.md).
//
// Here is the state, which the modules of motors, outputs and inputs ask for; survive.c, above
// them, has the host's commands and the decision to brake.
//
//   state    event → next state
//   all      survive_arm → RESTING; survive_home → HOMING; survive_off, a shutdown → OFF
//   HOMING   a step comes too late → LOST
//   RESTING  a commit that ends in motion → MOVING; one that comes too late → BRAKING
//   MOVING   a commit that ends at a standstill → RESTING; none in time → BRAKING
//   BRAKING  the motors stand → HELD
#pragma once
#include <stdbool.h>
#include <stdint.h>

enum {
  SURVIVE_OFF,
  SURVIVE_HOMING,   // endstops stop the motors, and no commits come
  SURVIVE_RESTING,  // the last commit ends at standstill
  SURVIVE_MOVING,   // the next commit must come in time
  SURVIVE_BRAKING,
  SURVIVE_HELD,
  SURVIVE_LOST,  // a step came too late while axes homed: the motors stopped at unknown positions
};

// Written by the foreground, and by the timer while the state is SURVIVE_MOVING: then the
// foreground needs hal_irq_save().
extern struct survive {
  volatile uint8_t state;
  volatile bool report_pending;  // clock of a decision
  bool missed;                   // see survive_miss(); written by the foreground
} survive;

// Returns whether moves wait for a commit; and whether moves are too late for one. Foreground.
bool survive_stages(void);
bool survive_refuses(void);
// Returns true if an output without a host is kept; otherwise the board shuts down. Any context.
bool survive_is_on(void);
// Returns a clock of the host. While the board survives a bad link, a clock in the past becomes the
// present one. Any context.
uint32_t survive_in_time(uint32_t clock);
// Returns whether axes home. Foreground.
bool survive_is_homing(void);
// A step came too late while axes homed, and all motors have stopped. Foreground.
void survive_lose(void);
// The moves of the next commit came too late: the commit will be refused. Foreground.
void survive_miss(void);
