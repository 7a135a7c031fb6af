// Cortex-M chips. board.h, made by the build, says which chip, its clock and its baud rate; what
// differs from chip to chip is in the folder of that chip (layer.h).
//
// SysTick is the one alarm, of the steps and of the scheduler; a counter that runs freely is the
// clock. Steps run in SysTick's interrupt, the most urgent; timers in PendSV's, the least urgent.
#pragma once
#include <stdbool.h>
#include <stdint.h>

#include "board.h"
#include "registers.h"

#define HAL_CLOCK_HZ BOARD_CLOCK_HZ
#define HAL_STEPPERS 12
#define HAL_MOVES_MAX 1024
#define HAL_COMMIT_WORK (HAL_CLOCK_HZ / 2000)

#define HAL_CONST
#define hal_const8(p) (*(const uint8_t *)(p))
#define hal_const16(p) (*(const uint16_t *)(p))
#define hal_const32(p) (*(const uint32_t *)(p))
#define hal_const_pointer(p) (*(p))

#define HAL_PWM_MAX 255

struct hal_analog {
  uint8_t input;
};

static inline uint32_t hal_clock(void) { return chip_clock(); }
static inline void stepgen_wait(uint32_t clock) {
  while ((int32_t)(chip_clock() - clock) <= 0) {
  }
}

typedef uint32_t hal_irq_t;

static inline hal_irq_t hal_irq_save(void) {
  hal_irq_t state;
  __asm__ volatile("mrs %0, primask\n cpsid i" : "=r"(state)::"memory");
  return state;
}

static inline void hal_irq_restore(hal_irq_t state) {
  __asm__ volatile("msr primask, %0" ::"r"(state) : "memory");
}
