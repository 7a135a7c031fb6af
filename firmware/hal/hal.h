// The contract between the core and the hardware layer of a family of chips. `chip.h` of that
// family (found by the include path) says what its pins are and how wide its numbers; the rest is
// this file.
//
// Three contexts, a later one interrupting an earlier one:
//
//   foreground   core_task(): commands, reports
//   timer        sched_interrupt(), which the layer calls when the alarm is due; not reentrant
//   generator    interrupts of the step generator and of the console; they call nothing in the core
//
// The layer's main loop calls core_task() and, where the chip has one, feeds a watchdog: if that
// loop stands still for a second or so, the chip starts anew.
//
// hal_irq_save() keeps the other two out. Clocks are 32-bit ticks of HAL_CLOCK_HZ and wrap; a is
// before b if (int32_t)(a - b) < 0.
//
// chip.h defines
//   HAL_CLOCK_HZ          ticks a second
//   HAL_STEPPERS          axes of the step generator, at most
//   HAL_ARENA             bytes for configured objects and move slots
//   HAL_MOVES_MAX         move slots, at most (the host counts no more than 1024)
//   HAL_COMMIT_WORK       ticks in which the first moves of a commit are queued (survive_state.h)
//   HAL_SHORTEST_PERIOD   ticks between two samples of an input that the chip can keep up with
//   HAL_PWM_MAX           the value of a PWM output that means fully on. With CLOCK_FREQ, ADC_MAX,
//                         MCU and RECEIVE_WINDOW (bytes that the console holds) it is also
//                         declared as a constant of the dictionary
//   HAL_ANALOG_WAIT       ticks after which a conversion that was not ready is asked for again
//   hal_irq_t             what hal_irq_save() returns
//   struct hal_output, struct hal_input, struct hal_analog, struct hal_pwm
//   HAL_CONST, hal_const8(p), hal_const16(p), hal_const32(p), hal_const_pointer(p)
//                         where constant tables live, and how a byte, … of them is read
// and may define
//   hal_crc16(crc, byte)  a faster step of the frame's checksum than the one in codec.h
//   HAL_DICTIONARY, HAL_DICTIONARY_SIZE   another dictionary than the build's
//   HAL_WAIT(ticks)       waits up to 0x7fff ticks, also under hal_irq_save(); else the core
//                         reads the clock
//   HAL_WATCH_OUTPUT(pin, value, full)    sees the value of each output as it changes
// A function declared below may be defined `static inline` in chip.h.
#pragma once
#include <stdbool.h>
#include <stdint.h>

#include "chip.h"

// ---- Time

uint32_t hal_clock(void);

// Calls sched_interrupt() at `clock` or as soon after as can be; at once if that is past. A newer
// clock replaces the older. It may be called too early as well: the core asks again. Any context.
void hal_alarm(uint32_t clock);

hal_irq_t hal_irq_save(void);
void hal_irq_restore(hal_irq_t state);

// Restarts the chip, as if powered on; does not return. Foreground.
_Noreturn void hal_reset(void);

// ---- Console: foreground only

// Returns the next received byte, or -1.
int16_t hal_console_read(void);
// Returns the bytes that hal_console_write() takes now without waiting; 255 when everything has
// been sent.
uint8_t hal_console_room(void);
void hal_console_write(const uint8_t *data, uint8_t size);

// ---- Pins: by the number that the dictionary's enumeration `pin` gives them

// Each setup returns false, and leaves the pin unchanged, if the pin does not have this function.
// Foreground. A pin that was both input and output changes between them in any context.
bool hal_output_setup(struct hal_output *output, uint16_t pin, bool level);
bool hal_input_setup(struct hal_input *input, uint16_t pin, bool pull_up);
bool hal_analog_setup(struct hal_analog *analog, uint16_t pin);
// Takes the achievable cycle nearest to `cycle`. 0 ≤ value ≤ HAL_PWM_MAX.
bool hal_pwm_setup(struct hal_pwm *pwm, uint16_t pin, uint32_t cycle, uint16_t value);

// Any context.
void hal_output_write(const struct hal_output *output, bool level);
bool hal_input_read(const struct hal_input *input);
void hal_pwm_write(const struct hal_pwm *pwm, uint16_t value);

// Timer context. Returns true and the value when a conversion is ready. Otherwise starts one if the
// converter is free and returns false: call it again HAL_ANALOG_WAIT later.
bool hal_analog_read(const struct hal_analog *analog, uint16_t *value);
// Drops a conversion that was started and not read. Any context.
void hal_analog_cancel(const struct hal_analog *analog);

// Sends bytes on one wire to a chain of lights, the highest bit of each byte first. A bit begins
// with a pulse: 0.2 to 0.5 us for a 0, 0.7 to 1.2 us for a 1. Interrupts are off only during each
// pulse. Returns false, and sends no further bits, if a bit takes more than `bit_max` ticks: the
// chain shows what has arrived. Foreground.
bool hal_lights_send(const struct hal_output *output, const uint8_t *data, uint16_t size,
                     uint16_t bit_max);

// ---- Step generator: hal/common/stepgen.c over one alarm, or the chip's own

// Steps of one motor: step k of `count` (from 1) comes (k - 1)·add + interval after the one before.
// A slot of the pool that all motors and outputs share. From stepgen_append() until
// stepgen_reclaim() it belongs to the generator, which writes `next` alone.
struct move {
  struct move *next;
  uint32_t interval;
  uint16_t count;  // not 0
  int16_t add;
  uint8_t direction;  // level of the direction pin, 0 or 1
};

// Axes are numbered from 0 in the order of their setup. `invert`: the step pin is high at rest. A
// pulse lasts at least `pulse_ticks`; the direction pin changes right after the last pulse of the
// previous move. Foreground, before any other call for that axis. Returns false if a pin does not
// have the function, or there are too many axes.
bool stepgen_setup(uint8_t axis, uint16_t step_pin, uint16_t direction_pin, bool invert,
                   uint16_t pulse_ticks);
// Queues a move whose first step is due at `first`. The generator uses `first` only if the axis is
// idle; otherwise it equals the end of the queued moves plus the interval. Returns false, and does
// not take the move, if the axis is idle and `first` is past, or after a stop. Foreground.
bool stepgen_append(uint8_t axis, struct move *move, uint32_t first);
// Returns true until the last queued step has been made. Any context.
bool stepgen_active(uint8_t axis);
// Stops all further edges and drops the queued moves, which stepgen_reclaim() returns. Any context,
// also while the foreground is in another call for the same axis.
void stepgen_stop(uint8_t axis);
// Accepts moves again. Any context.
void stepgen_resume(uint8_t axis);
// Returns the steps with direction 1 minus the steps with direction 0, since setup. Any context.
int32_t stepgen_position(uint8_t axis);
// Returns a move that the generator no longer uses (as soon as it is loaded), or null. Foreground.
struct move *stepgen_reclaim(uint8_t axis);
