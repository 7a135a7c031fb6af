// MK20DX128 (reference manual K20P64M50SF0): differences from the family.
#pragma once
#define CHIP_CORE_HZ 48000000UL
#define CHIP_CLOCK_HZ CHIP_CORE_HZ
#define CHIP_BUS_HZ 48000000UL
#define CHIP_DIVIDERS (0u << 28 | 0u << 24 | 1u << 16)  // core, bus, flash at 24 MHz
#define CHIP_PLL_FACTOR 24                              // of 2 MHz
#define CHIP_IRQS 46
#define CHIP_UART1_IRQ 18
#define CHIP_TIMERS (3u << 24)  // FTM0, FTM1
#define CHIP_SLOW_TIMERS 0u
#define HAL_ARENA 8192

#include "mk20.h"
