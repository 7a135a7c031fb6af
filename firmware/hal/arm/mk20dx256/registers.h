// MK20DX256 (reference manual K20P64M72SF1): differences from the family.
#pragma once
#define CHIP_CORE_HZ 72000000UL
#define CHIP_CLOCK_HZ CHIP_CORE_HZ
#define CHIP_BUS_HZ 36000000UL
#define CHIP_DIVIDERS (0u << 28 | 1u << 24 | 2u << 16)  // core, bus, flash at 24 MHz
#define CHIP_PLL_FACTOR 36                              // of 2 MHz
#define CHIP_IRQS 95
#define CHIP_UART1_IRQ 47
#define CHIP_TIMERS (3u << 24)       // FTM0, FTM1
#define CHIP_SLOW_TIMERS (1u << 24)  // FTM2, whose gate is in another register
#define HAL_ARENA 32768

#include "mk20.h"
