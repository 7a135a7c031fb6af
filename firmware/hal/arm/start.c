// From power-on to the foreground: vectors, memory, the order in which the parts start.
#include <stdint.h>

#include "alarm.h"
#include "console.h"
#include "core.h"
#include "cortex.h"
#include "hal.h"
#include "layer.h"
#include "scheduler.h"
#include "stepgen.h"

extern uint32_t data_begin[], data_end[], data_load[], bss_begin[], bss_end[], stack_top[];
extern uint32_t image_end[];

// An unexpected interrupt or a fault restarts the board, with outputs as after power-on.
static void unexpected(void) { chip_reset(); }

typedef void (*handler)(void);
#define EXCEPTIONS 16
#define OWN_MARK 0x6F737350u  // "Psso": the word before it is where the image ends in flash
extern const handler vectors[];

_Noreturn void reset_handler(void) {
  watchdog_start();
  for (uint32_t *to = data_begin, *from = data_load; to < data_end;) *to++ = *from++;
  for (uint32_t *to = bss_begin; to < bss_end;) *to++ = 0;
  SCB_VTOR = (uint32_t)vectors;  // a loader may have set another stack
  chip_start();
  alarm_start();
  console_start();
  analog_start();
  stepgen_start();
  core_start(0);
  NVIC_IPR(CHIP_UART_IRQ) = 0x40404040u;
  NVIC_ISER(CHIP_UART_IRQ) = 1u << CHIP_UART_IRQ % 32;
  __asm__ volatile("cpsie i" ::: "memory");
  // Watchdogs have slow clocks of their own; some accept no second word until they have taken the
  // first.
  for (uint32_t fed = chip_clock();;) {
    core_task();
    if (chip_clock() - fed < HAL_CLOCK_HZ / 100) continue;
    fed = chip_clock();
    if (timers_run()) watchdog_feed();
  }
}

void hal_reset(void) { chip_reset(); }

__attribute__((section(".vectors"), used)) const handler vectors[EXCEPTIONS + CHIP_IRQS] = {
    [0] = (handler)stack_top,
    [1] = reset_handler,
    [2 ... 6] = unexpected,
    [7] = (handler)image_end,  // the core reserves 7 to 10
    [8] = (handler)OWN_MARK,
    [11] = unexpected,
    [14] = timer_interrupt,
    [15] = alarm_interrupt,
    [EXCEPTIONS... EXCEPTIONS + CHIP_UART_IRQ - 1] = unexpected,
    [EXCEPTIONS + CHIP_UART_IRQ] = console_interrupt,
    [EXCEPTIONS + CHIP_UART_IRQ + 1 ... EXCEPTIONS + CHIP_IRQS - 1] = unexpected,
};
