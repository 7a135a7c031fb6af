// The console's interrupts and the alarm's: as short a time as can be with the others kept out.
// The registers they change without saving them belong to interrupts: see steps.S.
#include <avr/io.h>

#include "console.h"

#define flags r2
#define t0 r6

  .section .progmem.gcc.interrupts, "ax", @progbits

  .global USART0_RX_vect
USART0_RX_vect:
  in flags, _SFR_IO_ADDR(SREG)
  lds t0, UDR0
  push r30
  push r31
  lds r30, received_end
  ldi r31, hi8(received)
  st Z, t0
  inc r30
  sts received_end, r30
  pop r31
  pop r30
  out _SFR_IO_ADDR(SREG), flags
  reti

  .global USART0_UDRE_vect
USART0_UDRE_vect:
  in flags, _SFR_IO_ADDR(SREG)
  push r30
  push r31
  lds r30, sent_begin
  ldi r31, hi8(sent)
  ld t0, Z
  sts UDR0, t0
  inc r30
  sts sent_begin, r30
  lds t0, sent_end
  cp r30, t0
  brne 1f
  ldi r30, CONSOLE_QUIET
  sts UCSR0B, r30
1:
  pop r31
  pop r30
  out _SFR_IO_ADDR(SREG), flags
  reti

#ifdef TCNT5
#define ALARM_vect TIMER5_COMPC_vect
#else
#define ALARM_vect TIMER2_COMPA_vect
#endif

  .text
  .global ALARM_vect
ALARM_vect:
  push r0
  in r0, _SFR_IO_ADDR(SREG)
  sei  // its own flag does not rise again before alarm_due() sets it
  push r0
  push r1
  clr r1
  .irp n, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27, 30, 31
  push r\n
  .endr
  call alarm_due
  .irp n, 31, 30, 27, 26, 25, 24, 23, 22, 21, 20, 19, 18
  pop r\n
  .endr
  pop r1
  pop r0
  out _SFR_IO_ADDR(SREG), r0
  pop r0
  reti
