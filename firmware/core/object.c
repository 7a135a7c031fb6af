#include "object.h"

#include <stddef.h>
#include <string.h>

#include "command.h"
#include "hooks.h"
#include "shutdown.h"

DECL_SHUTDOWN_REASON(OID_TAKEN, "Can't assign oid");
DECL_SHUTDOWN_REASON(INVALID_OID, "Invalid oid type");
DECL_SHUTDOWN_REASON(ARENA_FULL, "alloc_chunks failed");
DECL_SHUTDOWN_REASON(NOT_FINALIZED, "Command before finalize_config");
DECL_SHUTDOWN_REASON(FINALIZED, "Configuration is finalized already");
DECL_SHUTDOWN_REASON(SLOTS_EXHAUSTED, "Move queue overflow");
DECL_REPORT("config is_config=%c crc=%u is_shutdown=%c move_count=%hu");

static _Alignas(struct move) _Alignas(void *) uint8_t arena[HAL_ARENA];
static size_t used;
static struct object **objects;  // null before allocate_oids
static uint8_t object_count;
static bool finalized;
static uint32_t crc;
static uint16_t slots;
// Written by foreground and timer under hal_irq_save().
static struct move *free_moves;

DECL_START(objects_start);
void objects_start(void) {
  used = 0;
  object_count = 0;
  objects = NULL;
  finalized = false;
  crc = 0;
  slots = 0;
  free_moves = NULL;
}

static void *arena_take(size_t size) {
  size = (size + _Alignof(struct move) - 1) / _Alignof(struct move) * _Alignof(struct move);
  if (size > sizeof arena - used) {
    shut_down(SHUTDOWN_ARENA_FULL);
    return NULL;
  }
  void *taken = arena + used;
  used += size;
  memset(taken, 0, size);
  return taken;
}

void *object_add(uint32_t oid, const struct object_kind *kind, size_t size) {
  if (oid >= object_count || finalized || objects[oid] != NULL) {
    shut_down(SHUTDOWN_OID_TAKEN);
    return NULL;
  }
  struct object *object = arena_take(size);
  if (object == NULL) return NULL;
  object->kind = kind;
  hal_irq_t irq = hal_irq_save();
  objects[oid] = object;
  hal_irq_restore(irq);
  return object;
}

void *object_find(uint32_t oid, uint8_t type) {
  if (oid >= object_count || objects[oid] == NULL || objects[oid]->kind->type != type) return NULL;
  return objects[oid];
}

void *object_get(uint32_t oid, uint8_t type) {
  void *object = object_find(oid, type);
  if (object == NULL) shut_down(SHUTDOWN_INVALID_OID);
  return object;
}

void *object_next(int16_t *oid, uint8_t type) {
  while (++*oid < object_count) {
    void *object = object_find((uint32_t)*oid, type);
    if (object != NULL) return object;
  }
  return NULL;
}

// In ascending order of their numbers.
DECL_ON_SHUTDOWN(objects_shut_down);
void objects_shut_down(void) {
  for (uint8_t oid = 0; oid < object_count; ++oid) {
    struct object *object = objects[oid];
    if (object != NULL && object->kind->shut_down != NULL) object->kind->shut_down(object);
  }
}

bool is_finalized(void) { return finalized; }

bool check_finalized(void) {
  if (!finalized) shut_down(SHUTDOWN_NOT_FINALIZED);
  return finalized;
}

uint16_t move_count(void) { return slots; }

struct move *move_take(void) {
  if (!check_finalized()) return NULL;
  if (free_moves == NULL) hooks_pool_empty();
  hal_irq_t irq = hal_irq_save();
  struct move *move = free_moves;
  if (move != NULL) free_moves = move->next;
  hal_irq_restore(irq);
  if (move == NULL) shut_down(SHUTDOWN_SLOTS_EXHAUSTED);
  return move;
}

void move_free(struct move *move) {
  hal_irq_t irq = hal_irq_save();
  move->next = free_moves;
  free_moves = move;
  hal_irq_restore(irq);
}

DECL_COMMAND(command_allocate_oids, "allocate_oids count=%c", 0);
void command_allocate_oids(const uint32_t *args) {
  if (objects != NULL) {
    shut_down(SHUTDOWN_OID_TAKEN);
    return;
  }
  struct object **list = arena_take(args[0] * sizeof(struct object *));
  if (list == NULL) return;
  objects = list;
  object_count = (uint8_t)args[0];
}

DECL_COMMAND(command_finalize_config, "finalize_config crc=%u", 0);
void command_finalize_config(const uint32_t *args) {
  if (finalized || objects == NULL) {
    shut_down(SHUTDOWN_FINALIZED);
    return;
  }
  size_t room = (sizeof arena - used) / sizeof(struct move);
  slots = room < HAL_MOVES_MAX ? (uint16_t)room : HAL_MOVES_MAX;
  struct move *moves = (struct move *)(void *)(arena + used);
  for (uint16_t i = slots; i > 0; --i) move_free(&moves[i - 1]);
  crc = args[0];
  finalized = true;
}

DECL_COMMAND(command_get_config, "get_config", IN_SHUTDOWN);
void command_get_config(const uint32_t *args) {
  (void)args;
  report(REPORT_CONFIG, (uint32_t[]){finalized, crc, is_shut_down(), slots}, 4);
}
