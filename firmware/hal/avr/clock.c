#include "clock.h"

#include <avr/interrupt.h>

#include "hal.h"
#include "scheduler.h"

uint16_t timer_offset[6];
static volatile uint16_t clock_high;

// The offset of timer `n` from timer 1: both low bytes are read in sequence, 2 ticks apart, and
// latch the high bytes.
#define MEASURE(n)                                                              \
  do {                                                                          \
    uint8_t low1, low, high1, high;                                             \
    __asm__ volatile("lds %0, %4\n lds %1, %5\n lds %2, %4+1\n lds %3, %5+1"    \
                     : "=&r"(low1), "=&r"(low), "=&r"(high1), "=&r"(high)       \
                     : "n"(_SFR_MEM_ADDR(TCNT1)), "n"(_SFR_MEM_ADDR(TCNT##n))); \
    timer_offset[n] = (uint16_t)((high << 8 | low) - (high1 << 8 | low1) - 2);  \
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
  union {
    struct {
      uint16_t low, high;
    };
    uint32_t clock;
  } now = {{TCNT1, clock_high}};
  if ((TIFR1 & 1 << TOV1) && now.low < 0x8000) ++now.high;
  hal_irq_restore(irq);
  return now.clock;
}

// The alarm: a 16-bit compare, or an 8-bit compare in units of 64 ticks. An alarm beyond that range
// fires early, which hal_alarm() allows.
#ifdef TCNT5
#define ALARM_MASK TIMSK5
#define ALARM_FLAGS TIFR5
#define ALARM_BIT OCIE5C
#define SOONEST 40  // ticks to the alarm for a clock in the past
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
  ALARM_MASK |= 1 << ALARM_BIT;
#ifdef TCNT5
  // Set before the clock is read, so that a later match is not missed.
  OCR5C = (uint16_t)clock + timer_offset[5];
  ALARM_FLAGS = 1 << ALARM_BIT;
  if ((int32_t)(clock - hal_clock()) <= 0) OCR5C = TCNT5 + SOONEST;
#else
  int32_t left = (int32_t)(clock - hal_clock());
  uint8_t units = left < UNIT ? 2 : left >= UNIT * FARTHEST ? FARTHEST : left / UNIT + 2;
  OCR2A = TCNT2 + units;
  ALARM_FLAGS = 1 << ALARM_BIT;
#endif
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
  cli();
  ALARM_MASK &= (uint8_t)~(1 << ALARM_BIT);  // another match may come before the timers have run
  running = true;
  asked = false;
  sei();
  sched_interrupt();
  cli();
  running = false;
  if (asked) set_alarm(asked_for);
}
