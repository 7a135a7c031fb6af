// Start of the step generator on AVR chips, see hal.h.
#pragma once

void stepgen_start(void);
