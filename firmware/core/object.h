// The objects that the host configures, by number (oid), and the pool of move slots.
//
// Both live in one arena: objects are taken from its front while the host configures; what is left
// becomes slots when it finalizes. Nothing is given back until the chip is reset.
#pragma once
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "declare.h"
#include "declared.h"
#include "hal.h"

enum object_type {
  OBJECT_STEPPER = 1,
  OBJECT_ENDSTOP,
  OBJECT_TRSYNC,
  OBJECT_ANALOG_IN,
  OBJECT_DIGITAL_OUT,
  OBJECT_PWM_OUT,
  OBJECT_BUTTONS,
  OBJECT_SPI,
  OBJECT_SPI_SHUTDOWN,
  OBJECT_TMCUART,
  OBJECT_I2C,
  OBJECT_THERMOCOUPLE,
  OBJECT_ACCELEROMETER,
  OBJECT_COUNTER,
  OBJECT_NEOPIXEL,
};

// A function that is called for each object of one kind.
struct object_kind {
  uint8_t type;
  void (*shut_down)(void *object);  // under hal_irq_save(), any context; or null
};

// Common header of all objects.
struct object {
  const struct object_kind *kind;
};

// Creates a zeroed object. Shuts down and returns null if the number is taken or the arena is full.
void *object_add(uint32_t oid, const struct object_kind *kind, size_t size);
// Returns the object of this type. Without one, the first form shuts down and returns null; the
// second form only returns null.
void *object_get(uint32_t oid, uint8_t type);
void *object_find(uint32_t oid, uint8_t type);
// The next object of this type after *oid (start with -1), or null; for (;;) over all of them.
void *object_next(int16_t *oid, uint8_t type);

// Returns whether the configuration is complete. The second form shuts down if it is not.
bool is_finalized(void);
bool check_finalized(void);
// Slots in the pool, 0 before the configuration is complete.
uint16_t move_count(void);
// Takes a slot; shuts down and returns null if none is free. Before that,
// DECL_ON_POOL_EMPTY may free some first. Foreground.
struct move *move_take(void);
// Returns a slot to the pool. Any context.
void move_free(struct move *move);
