// A chip of which the step generator alone is tried: see trial.c.
#pragma once
#include <stdbool.h>
#include <stdint.h>

#define HAL_CLOCK_HZ 84000000
#define HAL_STEPPERS 6
#define HAL_MOVES_MAX 1024
#define HAL_CONST

struct hal_output {
  uint16_t pin;
};
struct hal_input {
  uint16_t pin;
};
struct hal_analog {
  uint16_t pin;
};
struct hal_pwm {
  uint16_t pin;
};
typedef int hal_irq_t;
