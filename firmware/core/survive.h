// What the board does when its host falls silent in the midst of a print: it stops the motors on
// their path, by moves that the host sent for that case, and keeps heaters warm for a while. Only
// hosts that ask for it get it (docs/decisions/0013-survive.md).
#pragma once
#include <stdbool.h>
#include <stdint.h>

// Whether moves wait for a commit; whether they come too late for one. Foreground.
bool survive_stages(void);
bool survive_refuses(void);
// Whether an output that the host does not renew is held rather than a reason to shut down. Any
// context.
bool survive_is_on(void);
// Whether a sensor with a range is being sampled: without, nothing is kept but at its default. Any
// context.
bool survive_watches(void);
// A clock of the host's; one that is past, while the board survives a bad link, becomes one that is
// not. Any context.
uint32_t survive_in_time(uint32_t clock);
// A step has come too late. While axes home all motors stop then, and the host is told: true. False
// if it is a reason to shut down. Foreground.
bool survive_gives_up(void);
// What the next commit's moves need came too late: it will be refused. Foreground.
void survive_missed(void);
// Brakes when that was decided; forgets all after a shutdown. Foreground.
void survive_task(void);
void survive_start(void);
