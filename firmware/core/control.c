#include "control.h"

#include "command.h"
#include "frame.h"
#include "hooks.h"
#include "scheduler.h"
#include "shutdown.h"
#include "spi.h"

DECL_REPORT("identify_response offset=%u data=%.*s");
DECL_REPORT("clock clock=%u");
DECL_REPORT("uptime high=%u clock=%u");
DECL_REPORT("starting");
DECL_REPORT("pong data=%*s");
DECL_REPORT("stats count=%u sum=%u sumsq=%u");
DECL_REPORT("counters frames=%u naks=%u dropped=%u");
DECL_CONSTANT("STATS_SUMSQ_BASE", 256);

#define SUMSQ_BASE 256
#define STATS_PERIOD (5 * (uint32_t)HAL_CLOCK_HZ)
#define IDENTIFY_MAX 48

static uint32_t high, low;  // clock of the last pass
static bool starting;
// The load since `stats_since`: the number of passes of the foreground, the ticks of the busy ones,
// and the sum of their squares in units of SUMSQ_BASE.
static uint32_t stats_since, passes, ticks, squares;
static bool heartbeat_run(struct timer *timer);
static struct timer heartbeat = {.run = heartbeat_run, .lasting = true};

static bool heartbeat_run(struct timer *timer) {
  timer->wake += STATS_PERIOD;
  task_wake();
  return true;
}

void control_start(uint32_t clock_high) {
  high = clock_high;
  low = stats_since = hal_clock();
  passes = ticks = squares = 0;
  starting = true;
  heartbeat.wake = low + STATS_PERIOD;
  timer_add(&heartbeat);
}

void control_task(uint32_t began, bool busy) {
  uint32_t now = hal_clock(), spent = now - began;
  if (now < low) ++high;
  low = now;
  ++passes;
  if (busy) {
    ticks += spent;
    uint32_t square = spent <= 0xffff ? (spent * spent + SUMSQ_BASE - 1) / SUMSQ_BASE
                                      : (spent + SUMSQ_BASE - 1) / SUMSQ_BASE * spent;
    squares = squares + square < squares ? UINT32_MAX : squares + square;
  }
  if (starting) starting = !report(REPORT_STARTING, 0, 0);
  if (now - stats_since < STATS_PERIOD) return;
  if (!report(REPORT_STATS, (uint32_t[]){passes, ticks, squares}, 3)) return;
  stats_since = now;
  passes = ticks = squares = 0;
}

DECL_COMMAND(command_identify, "identify offset=%u count=%c", IN_SHUTDOWN);
void command_identify(const uint32_t *args) {
  uint8_t part[IDENTIFY_MAX];
  uint16_t all = HAL_DICTIONARY_SIZE;
  uint16_t from = args[0] < all ? (uint16_t)args[0] : all;
  uint16_t size = (uint16_t)args[1];
  if (size > all - from) size = all - from;
  if (size > IDENTIFY_MAX) size = IDENTIFY_MAX;
  for (uint16_t i = 0; i < size; ++i) part[i] = hal_const8(&HAL_DICTIONARY[from + i]);
  report_bytes(REPORT_IDENTIFY_RESPONSE, args, 1, part, (uint8_t)size);
}

DECL_COMMAND(command_get_clock, "get_clock", IN_SHUTDOWN);
void command_get_clock(const uint32_t *args) {
  (void)args;
  report(REPORT_CLOCK, (uint32_t[]){hal_clock()}, 1);
}

DECL_COMMAND(command_get_uptime, "get_uptime", IN_SHUTDOWN);
void command_get_uptime(const uint32_t *args) {
  (void)args;
  uint32_t now = hal_clock();
  report(REPORT_UPTIME, (uint32_t[]){high + (now < low), now}, 2);
}

DECL_COMMAND(command_get_counters, "get_counters", IN_SHUTDOWN);
void command_get_counters(const uint32_t *args) {
  (void)args;
  report(REPORT_COUNTERS,
         (uint32_t[]){frame_counts.frames, frame_counts.naks, frame_counts.dropped}, 3);
}

DECL_COMMAND(command_reset, "reset", IN_SHUTDOWN);
void command_reset(const uint32_t *args) {
  (void)args;
  hal_irq_save();
  hooks_shut_down();
  spi_send_last();
  hal_reset();
}

DECL_COMMAND(command_debug_nop, "debug_nop", IN_SHUTDOWN);
void command_debug_nop(const uint32_t *args) { (void)args; }

DECL_COMMAND(command_debug_ping, "debug_ping data=%*s", IN_SHUTDOWN);
void command_debug_ping(const uint32_t *args) {
  report_bytes(REPORT_PONG, 0, 0, command_bytes(), (uint8_t)args[0]);
}
