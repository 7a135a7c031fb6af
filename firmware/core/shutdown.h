// The state in which nothing moves and nothing heats.
//
// A shutdown, for whatever reason, halts all motors, puts all outputs to their default and disarms
// what could start them again, before shut_down() returns. A pin that was set without being
// configured as an output (set_digital_out, set_pwm_out) keeps its level. It lasts until
// clear_shutdown or reset. The foreground may be interrupted by one in the midst of a command; so
// whatever a command sets in motion it does under hal_irq_save() and only if !is_shut_down() there.
#pragma once
#include <stdbool.h>
#include <stdint.h>

#include "declare.h"
#include "declared.h"

// Shuts down. `reason` is a SHUTDOWN_… number, not 0. Only the first reason counts. Any context.
void shut_down(uint8_t reason);
bool is_shut_down(void);
// The number of the reason; 0: not shut down.
uint8_t shutdown_reason(void);
// The clock of the last shutdown.
uint32_t shutdown_clock(void);
// Ends the shutdown. Foreground.
void shutdown_clear(void);
