// The hooks that the modules declare by DECL_START, DECL_TASK, … (declare.h describes when and in
// which context each is called). The build writes these functions into tables.c: each calls the
// declared functions, in their order. So a module calls modules above it without including them.
#pragma once
#include <stdbool.h>

void hooks_start(void);
void hooks_every_pass(void);  // tasks of the phase EVERY_PASS
void hooks_task(void);        // all other tasks
void hooks_shut_down(void);
void hooks_clear_shutdown(void);
void hooks_pool_empty(void);
bool hooks_watch(void);  // true if one of them returns true
