; The start of an AVR image for compilers that come without one: vectors, stack, main(). The
; compiler's library puts the initial values of variables in place between the two.
#include <avr/io.h>

.section .vectors, "ax", @progbits
  jmp start
.altmacro
.macro vector n
  .weak __vector_\n
  .set __vector_\n, unexpected
  jmp __vector_\n
.endm
.set i, 1
.rept _VECTORS_SIZE / 4 - 1
  vector %i
  .set i, i + 1
.endr

.section .init2, "ax", @progbits
start:
  clr r1
  out _SFR_IO_ADDR(SREG), r1
  ldi r28, lo8(RAMEND)
  ldi r29, hi8(RAMEND)
  out _SFR_IO_ADDR(SPL), r28
  out _SFR_IO_ADDR(SPH), r29
#ifdef RAMPZ
  out _SFR_IO_ADDR(RAMPZ), r1
#endif
#ifdef EIND
  out _SFR_IO_ADDR(EIND), r1
#endif

.section .init9, "ax", @progbits
  call main
unexpected:
  jmp 0
