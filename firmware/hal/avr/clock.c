#include "clock.h"

#include <avr/interrupt.h>

#include "hal.h"
#include "scheduler.h"

// The next alarm: so many ticks are needed to set it.
#define SOONEST 60

uint16_t timer_offset[6];
static volatile uint16_t clock_high;

// What timer `n` counts beyond timer 1: both low bytes are read one after the other, 2 ticks apart,
// and hold the high bytes.
#define MEASURE(n)                                                                     \
  do {                                                                                 \
    uint8_t low1, low, high1, high;                                                    \
    __asm__ volatile("lds %0, %4\n lds %1, %5\n lds %2, %4+1\n lds %3, %5+1"           \
                     : "=&r"(low1), "=&r"(low), "=&r"(high1), "=&r"(high)              \
                     : "n"(_SFR_MEM_ADDR(TCNT1)), "n"(_SFR_MEM_ADDR(TCNT##n)));        \
    timer_offset[n] = (uint16_t)((high << 8 | low) - (high1 << 8 | low1) - 2);         \
  } while (0)

void clock_start(void) {
  TCCR1B = TCCR3B = 1 << CS10;
  clock_high = 0;
  timer_offset[1] = 0;
  MEASURE(3);
#ifdef TCNT5
  TCCR4B = TCCR5B = 1 << CS10;
  MEASURE(4);
  MEASURE(5);
#else
  TCCR2B = 1 << CS22;
#endif
  TIMSK1 = 1 << TOIE1;
}

ISR(TIMER1_OVF_vect) { ++clock_high; }

uint32_t hal_clock(void) {
  hal_irq_t irq = hal_irq_save();
  uint16_t low = TCNT1, high = clock_high;
  if ((TIFR1 & 1 << TOV1) && low < 0x8000) ++high;
  hal_irq_restore(irq);
  return (uint32_t)high << 16 | low;
}

// The alarm: a compare of 16 bits, or of 8 bits in units of 64 ticks. One that is further away comes
// early, which hal_alarm() allows.
#ifdef TCNT5
#define ALARM_MASK TIMSK5
#define ALARM_FLAGS TIFR5
#define ALARM_BIT OCIE5C
#else
#define ALARM_MASK TIMSK2
#define ALARM_FLAGS TIFR2
#define ALARM_BIT OCIE2A
#define UNIT 64
#define FARTHEST 250
#endif

static volatile bool running, asked;
static volatile uint32_t asked_for;

static void set_alarm(uint32_t clock) {
  int32_t left = (int32_t)(clock - hal_clock());
#ifdef TCNT5
  if (left < SOONEST)
    OCR5C = TCNT5 + SOONEST;
  else
    OCR5C = (uint16_t)clock + timer_offset[5];
#else
  uint8_t units = left < SOONEST ? 2 : left >= UNIT * FARTHEST ? FARTHEST : left / UNIT + 2;
  OCR2A = TCNT2 + units;
#endif
  ALARM_FLAGS = 1 << ALARM_BIT;
  ALARM_MASK |= 1 << ALARM_BIT;
}

void hal_alarm(uint32_t clock) {
  hal_irq_t irq = hal_irq_save();
  if (running) {
    asked = true;
    asked_for = clock;
  } else {
    set_alarm(clock);
  }
  hal_irq_restore(irq);
}

// Called by the alarm's interrupt with interrupts enabled; leaves with them disabled, so that the
// interrupts of two alarms do not nest.
void alarm_due(void) {
  running = true;
  asked = false;
  sched_interrupt();
  cli();
  running = false;
  ALARM_MASK &= (uint8_t)~(1 << ALARM_BIT);
  if (asked) set_alarm(asked_for);
}
