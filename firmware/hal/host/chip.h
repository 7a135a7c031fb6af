// The host library: a chip that lives in a process of the host, in virtual time.
#pragma once
#include <stdint.h>

extern uint32_t host_clock_hz;
extern uint16_t host_moves_max;
extern const uint8_t *host_dictionary;
extern uint16_t host_dictionary_size;

#define HAL_CLOCK_HZ host_clock_hz
#define HAL_STEPPERS 32
#define HAL_ARENA (1 << 21)
#define HAL_MOVES_MAX host_moves_max
#define HAL_COMMIT_WORK 0
#define HAL_SHORTEST_PERIOD 100
#define HAL_ANALOG_WAIT 100
#define HAL_PWM_MAX 255
#define HAL_WAIT(ticks) ((void)(ticks))  // the clock stops while the core works

#define HAL_CONST
#define hal_const8(p) (*(const uint8_t *)(p))
#define hal_const16(p) (*(const uint16_t *)(p))
#define hal_const32(p) (*(const uint32_t *)(p))
#define hal_const_pointer(p) (*(p))

#define HAL_DICTIONARY host_dictionary
#define HAL_DICTIONARY_SIZE host_dictionary_size

typedef uint8_t hal_irq_t;
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

void host_watch_output(uint16_t pin, uint32_t value, uint32_t full);
#define HAL_WATCH_OUTPUT(pin, value, full) host_watch_output(pin, value, full)
