// What the chip does at its start for the step generator of hal.h.
#pragma once

void stepgen_start(void);
