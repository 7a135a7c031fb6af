// Declarations that the build gathers from the sources (src/passo/toolchain/declarations.py) into
// the table of commands, the data dictionary and the functions of hooks.h. They stand at file
// scope, unconditionally: what a board does not want is a source file left out. Numbers in them are
// literals.
//
//   DECL_COMMAND(handler, "name a=%c b=%u", flags)  handler(const uint32_t *args) in that source
//   DECL_REPORT("name a=%c b=%u")                    makes REPORT_NAME for report()
//   DECL_SHUTDOWN_REASON(NAME, "Text")               makes SHUTDOWN_NAME for shut_down()
//   DECL_CONSTANT("NAME", value)                     a number or a string of the dictionary
//   DECL_ENUMERATION("name", "KEY", value)
//   DECL_ENUMERATION_RANGE("name", "PA0", first, count)  PA0, PA1, …
//
// Hooks: functions of a module that modules below it call (hooks.h). All but the last are
// void function(void).
//
//   DECL_START(function)              Foreground. After each reset: sets the module's own state,
//                                     and calls no other module.
//   DECL_TASK(function, PHASE)        Foreground. In the main loop.
//   DECL_ON_SHUTDOWN(function)        Any context, under hal_irq_save(). At a shutdown and before
//                                     a reset: stops what the module drives.
//   DECL_ON_CLEAR_SHUTDOWN(function)  Foreground. Before a shutdown ends: completes what the
//                                     module left to the foreground.
//   DECL_ON_POOL_EMPTY(function)      Foreground. No slot is free: the module gives those that it
//                                     has finished with back by move_free().
//   DECL_WATCH(function)              Any context. bool function(void): true if a sensor of the
//                                     module shuts the board down when it leaves its range.
//
// Tasks run by phase, in this order. All but the first phase run only after task_wake():
//
//   EVERY_PASS  each time round the main loop
//   DEVICES     tells devices of a shutdown
//   MOTORS      events of motors
//   INPUTS      values that were sampled or received
//   BUSES       exchanges with devices, which take long
//   SHUTDOWN    the report of a shutdown, after the reports of what came before it
//
// Hooks of one kind, and tasks of one phase, run in the order of their files' names; those of one
// file as declared.
//
// Types of parameters: %c a byte, %hu a word, %u %i %hi a long, %*s bytes (at most one of these in
// a command: args[] holds their number, command_bytes() tells where they are).
#pragma once
#include <stdbool.h>
#include <stdint.h>

// The command also works after a shutdown.
#define IN_SHUTDOWN 1

#define DECL_COMMAND(handler, format, flags) void handler(const uint32_t *args)
#define DECL_REPORT(format) struct declared
#define DECL_SHUTDOWN_REASON(name, text) struct declared
#define DECL_CONSTANT(name, value) struct declared
#define DECL_ENUMERATION(name, key, value) struct declared
#define DECL_ENUMERATION_RANGE(name, key, first, count) struct declared

#define DECL_START(function) void function(void)
#define DECL_TASK(function, phase) void function(void)
#define DECL_ON_SHUTDOWN(function) void function(void)
#define DECL_ON_CLEAR_SHUTDOWN(function) void function(void)
#define DECL_ON_POOL_EMPTY(function) void function(void)
#define DECL_WATCH(function) bool function(void)
