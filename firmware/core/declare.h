// Declarations that the build gathers from the sources (src/passo/toolchain/declarations.py) into
// the table of commands and the data dictionary. They stand at file scope, unconditionally: what a
// board does not want is a source file left out. Numbers in them are literals.
//
//   DECL_COMMAND(handler, "name a=%c b=%u", flags)  handler(const uint32_t *args) in that source
//   DECL_REPORT("name a=%c b=%u")                    makes REPORT_NAME for report()
//   DECL_SHUTDOWN(NAME, "Text")                      makes SHUTDOWN_NAME for shutdown()
//   DECL_CONSTANT("NAME", value)                     a number or a string of the dictionary
//   DECL_ENUMERATION("name", "KEY", value)
//   DECL_ENUMERATION_RANGE("name", "PA0", first, count)  PA0, PA1, …
//
// Types of parameters: %c a byte, %hu a word, %u %i %hi a long, %*s bytes (at most one of these in a
// command: args[] holds their number, command_bytes() tells where they are).
#pragma once
#include <stdint.h>

// The command is also obeyed after a shutdown.
#define IN_SHUTDOWN 1

#define DECL_COMMAND(handler, format, flags) void handler(const uint32_t *args)
#define DECL_REPORT(format) struct declared
#define DECL_SHUTDOWN(name, text) struct declared
#define DECL_CONSTANT(name, value) struct declared
#define DECL_ENUMERATION(name, key, value) struct declared
#define DECL_ENUMERATION_RANGE(name, key, first, count) struct declared
