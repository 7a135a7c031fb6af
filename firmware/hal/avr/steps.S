// The step interrupts: one 16-bit compare unit a motor, free-running timers at the chip's clock.
//
// Registers r2 to r9 belong to these interrupts alone: everything else is compiled with
// -ffixed-r2 … -ffixed-r9, so nothing has to be saved but the flags.
//
// An interrupt raises the step pin, counts, moves its compare register on by the interval, lets the
// interval grow, and lowers the pin: 56 cycles with entry and return, the pulse being 38 of them.
// When the compare would come too late, because others were in the way, the next step is made at
// once; missing it would stall the motor for a whole turn of the timer. Intervals are below 32768
// ticks, so that the sign of TCNT - OCR tells late from early; longer ones are made of pieces.
#include <avr/io.h>

#include "board.h"
#include "unit.h"

#define flags r2
#define mask r3
#define interval0 r4
#define interval1 r5
#define t0 r6
#define t1 r7
#define u0 r8
#define u1 r9


// Right behind the vectors, where their jumps reach with rjmp.
  .section .progmem.gcc.steps, "ax", @progbits

// Lengthens the pulse of a unit with free pins.
.macro HOLD n
  lds t0, unit\n + UNIT_HOLD
  dec t0
  brne .-4
.endm

// Toggles what `value` says on the port at `pin`; Z points there if the pin is not fixed.
.macro TOGGLE fixed, pin, value
  .if \fixed
    .if (\pin) < 0x60
      out (\pin) - __SFR_OFFSET, \value
    .else
      sts \pin, \value
    .endif
  .else
      st Z, \value
  .endif
.endm

.macro LEAVE fixed
  .if !\fixed
  pop r31
  pop r30
  .endif
  out _SFR_IO_ADDR(SREG), flags
  reti
.endm

.macro STEP_INTERRUPT n, vector, ocr, tcnt, tifr, timsk, bit, fixed, step_pin, step_mask, dir_pin, dir_mask
  .equ unit\n, units + \n * UNIT_SIZE
  .global \vector
\vector:
  in flags, _SFR_IO_ADDR(SREG)
  .if !\fixed
  push r30
  push r31
  .endif
.Lstep\n:
  .if !\fixed
  lds r30, unit\n + UNIT_STEP_PIN
  lds r31, unit\n + UNIT_STEP_PIN + 1
  .endif
  lds mask, unit\n + UNIT_MASK
  TOGGLE \fixed, \step_pin, mask
  lds t0, unit\n + UNIT_COUNT
  dec t0
  sts unit\n + UNIT_COUNT, t0
  breq .Lnext_jump\n
.Lplan\n:
  lds interval0, unit\n + UNIT_INTERVAL
  lds interval1, unit\n + UNIT_INTERVAL + 1
  lds t0, \ocr
  lds t1, \ocr + 1
  add t0, interval0
  adc t1, interval1
  sts \ocr + 1, t1
  sts \ocr, t0
  lds u0, \tcnt
  lds u1, \tcnt + 1
  cp u0, t0
  cpc u1, t1
  brpl .Llate\n
  lds t0, unit\n + UNIT_ADD
  lds t1, unit\n + UNIT_ADD + 1
  add interval0, t0
  adc interval1, t1
  sts unit\n + UNIT_INTERVAL, interval0
  sts unit\n + UNIT_INTERVAL + 1, interval1
  .if !\fixed
  HOLD \n
  .endif
  TOGGLE \fixed, \step_pin, mask
  LEAVE \fixed
.Lnext_jump\n:
  rjmp .Lnext\n
.Llate\n:
  lds t0, unit\n + UNIT_ADD
  lds t1, unit\n + UNIT_ADD + 1
  add interval0, t0
  adc interval1, t1
  .if !\fixed
  HOLD \n
  .endif
  TOGGLE \fixed, \step_pin, mask
  sts unit\n + UNIT_INTERVAL, interval0
  sts unit\n + UNIT_INTERVAL + 1, interval1
.Lagain\n:
  set
  clr t0
  bld t0, \bit
  out (\tifr) - __SFR_OFFSET, t0  // only this unit's flag, so not sbi
  rjmp .+0                        // the pin is low for 17 cycles, 1 us at 16 MHz
  rjmp .+0
  .if !\fixed
  HOLD \n                         // or longer, if the pulse is
  .endif
  rjmp .Lstep\n

// The 256th step of a move, or its last.
.Lnext\n:
  lds t0, unit\n + UNIT_COUNT_HIGH
  tst t0
  breq 1f
  dec t0
  sts unit\n + UNIT_COUNT_HIGH, t0
  rjmp .Lplan\n
1:
  .if \fixed
  push r30
  push r31
  .endif
  lds r30, unit\n + UNIT_MODE
  tst r30
  brne .Lwide\n
  lds r30, unit\n + UNIT_NEXT
  lds r31, unit\n + UNIT_NEXT + 1
  adiw r30, 0
  breq .Lwide\n                   // nothing left
  ldd u1, Z + MOVE_DIRECTION
  sbrs u1, MOVE_FAST_BIT
.Lwide\n:
  rjmp .Lslow\n
  ldd t0, Z + MOVE_NEXT
  ldd t1, Z + MOVE_NEXT + 1
  sts unit\n + UNIT_NEXT, t0
  sts unit\n + UNIT_NEXT + 1, t1
  ldd t0, Z + MOVE_COUNT
  ldd t1, Z + MOVE_COUNT + 1
  sts unit\n + UNIT_COUNT, t0
  tst t0
  brne 1f
  dec t1
1:
  sts unit\n + UNIT_COUNT_HIGH, t1
  ldd interval0, Z + MOVE_INTERVAL
  ldd interval1, Z + MOVE_INTERVAL + 1
  lds t0, \ocr
  lds t1, \ocr + 1
  add t0, interval0
  adc t1, interval1
  sts \ocr + 1, t1
  sts \ocr, t0
  ldd u0, Z + MOVE_ADD
  sts unit\n + UNIT_ADD, u0
  add interval0, u0
  ldd u0, Z + MOVE_ADD + 1
  sts unit\n + UNIT_ADD + 1, u0
  adc interval1, u0
  sts unit\n + UNIT_INTERVAL, interval0
  sts unit\n + UNIT_INTERVAL + 1, interval1
  .if \fixed
  ldi r30, \step_mask
  sts unit\n + UNIT_MASK, r30
  TOGGLE \fixed, \step_pin, mask
  ldi r30, \dir_mask
  sbrc u1, MOVE_TOGGLE_BIT
  TOGGLE \fixed, \dir_pin, r30
  .else
  lds u0, unit\n + UNIT_STEP_MASK
  sts unit\n + UNIT_MASK, u0
  lds r30, unit\n + UNIT_STEP_PIN
  lds r31, unit\n + UNIT_STEP_PIN + 1
  push t0
  HOLD \n
  pop t0
  TOGGLE \fixed, \step_pin, mask
  lds r30, unit\n + UNIT_DIR_PIN
  lds r31, unit\n + UNIT_DIR_PIN + 1
  lds u0, unit\n + UNIT_DIR_MASK
  sbrc u1, MOVE_TOGGLE_BIT
  st Z, u0
  .endif
  lds u0, \tcnt
  lds u1, \tcnt + 1
  cp u0, t0
  cpc u1, t1
  .if \fixed
  pop r31
  pop r30
  .endif
  brpl 1f
  LEAVE \fixed
1:
  rjmp .Lagain\n

// Long intervals, and the end.
.Lslow\n:
  push r28
  push r29
  ldi r28, lo8(unit\n)
  ldi r29, hi8(unit\n)
  rcall step_next
  .if !\fixed
  HOLD \n
  lds r30, unit\n + UNIT_STEP_PIN
  lds r31, unit\n + UNIT_STEP_PIN + 1
  .endif
  TOGGLE \fixed, \step_pin, mask
  clr mask                        // the pulse is over
  pop r29
  pop r28
  brcs .Lstop\n
  lds t0, unit\n + UNIT_TOGGLE
  .if !\fixed
  lds r30, unit\n + UNIT_DIR_PIN
  lds r31, unit\n + UNIT_DIR_PIN + 1
  .endif
  TOGGLE \fixed, \dir_pin, t0
  .if \fixed
  pop r31
  pop r30
  .endif
  rjmp .Lplan\n
.Lstop\n:
  lds r30, \timsk
  andi r30, ~(1 << \bit)
  sts \timsk, r30
  sts unit\n + UNIT_ACTIVE, mask
  .if \fixed
  pop r31
  pop r30
  .endif
  LEAVE \fixed
.endm

// What follows the interrupt that ended a move or a piece of a long interval. Y: the unit. Sets
// interval, count and mask for the next interrupt and toggle for this one; carry if nothing is left
// to do. Changes Z, t0 to u1.
step_next:
  clr u0
  std Y + UNIT_TOGGLE, u0
  ldd r30, Y + UNIT_MODE
  tst r30
  breq .Lload
  rjmp .Lwide_next
.Lload:
  ldd r30, Y + UNIT_NEXT
  ldd r31, Y + UNIT_NEXT + 1
  adiw r30, 0
  brne 1f
  sec
  ret
1:
  ldd t0, Z + MOVE_NEXT
  ldd t1, Z + MOVE_NEXT + 1
  std Y + UNIT_NEXT, t0
  std Y + UNIT_NEXT + 1, t1
  ldd t0, Z + MOVE_DIRECTION
  ldd u1, Y + UNIT_DIR_MASK
  sbrc t0, MOVE_TOGGLE_BIT
  std Y + UNIT_TOGGLE, u1
  ldd interval0, Z + MOVE_ADD
  ldd interval1, Z + MOVE_ADD + 1
  std Y + UNIT_ADD, interval0
  std Y + UNIT_ADD + 1, interval1
  ldd interval0, Z + MOVE_INTERVAL
  ldd interval1, Z + MOVE_INTERVAL + 1
  sbrs t0, MOVE_FAST_BIT
  rjmp .Lload_wide
  ldd t0, Z + MOVE_COUNT  // after a move with long intervals
  ldd t1, Z + MOVE_COUNT + 1
// Short intervals: t1:t0 steps from interval1:interval0 on.
.Lfast:
  std Y + UNIT_INTERVAL, interval0
  std Y + UNIT_INTERVAL + 1, interval1
  std Y + UNIT_COUNT, t0
  cp u0, t0           // carry if the low byte is not 0
  brcs 1f
  dec t1
1:
  std Y + UNIT_COUNT_HIGH, t1
  ldd t0, Y + UNIT_STEP_MASK
  std Y + UNIT_MASK, t0
  clc
  ret

.Lload_wide:
  ldd t0, Z + MOVE_COUNT
  ldd t1, Z + MOVE_COUNT + 1
  std Y + UNIT_LEFT, t0
  std Y + UNIT_LEFT + 1, t1
  ldd t0, Z + MOVE_INTERVAL + 2
  ldd t1, Z + MOVE_INTERVAL + 3
  ldi r30, MODE_WIDE
  std Y + UNIT_MODE, r30
// The next step is t1:t0:interval1:interval0 ticks away: the odd ticks of that first, then pieces of
// 32768.
.Lbegin_wide:
  std Y + UNIT_WIDE, interval0
  std Y + UNIT_WIDE + 1, interval1
  std Y + UNIT_WIDE + 2, t0
  std Y + UNIT_WIDE + 3, t1
  lsl interval1       // t1:t0 = pieces of 32768, interval1:interval0 = the rest
  rol t0
  rol t1
  lsr interval1
  mov u1, interval0
  or u1, interval1
  brne .Lpiece
  mov u1, t0          // nothing odd: begin with a whole piece, if there is one
  or u1, t1
  breq .Lpiece
  ldi r30, 1
  sub t0, r30
  sbc t1, u0
  ldi r30, 0x80
  mov interval1, r30
// A wait of interval1:interval0, followed by t1:t0 whole pieces.
.Lpiece:
  std Y + UNIT_INTERVAL, interval0
  std Y + UNIT_INTERVAL + 1, interval1
  std Y + UNIT_CHUNKS, t0
  std Y + UNIT_CHUNKS + 1, t1
  ldi r30, 1
  std Y + UNIT_COUNT, r30
  or t0, t1
  ldd t1, Y + UNIT_STEP_MASK
  breq 1f
  clr t1
1:
  std Y + UNIT_MASK, t1
  clc
  ret

// r30: the mode.
.Lwide_next:
  ldd t0, Y + UNIT_CHUNKS
  ldd t1, Y + UNIT_CHUNKS + 1
  mov u1, t0
  or u1, t1
  breq 1f
  clr interval0
  ldi r31, 0x80
  mov interval1, r31
  ldi r31, 1
  sub t0, r31
  sbc t1, u0
  rjmp .Lpiece
1:                    // that was a step
  ldd interval0, Y + UNIT_LEFT
  ldd interval1, Y + UNIT_LEFT + 1
  ldi r31, 1
  sub interval0, r31
  sbc interval1, u0
  std Y + UNIT_LEFT, interval0
  std Y + UNIT_LEFT + 1, interval1
  mov u1, interval0
  or u1, interval1
  brne 2f
  std Y + UNIT_MODE, u0
  rjmp .Lload
2:
  sbrs r30, 1         // MODE_THEN_FAST
  rjmp 3f
  std Y + UNIT_MODE, u0
  mov t0, interval0
  mov t1, interval1
  ldd interval0, Y + UNIT_WIDE
  ldd interval1, Y + UNIT_WIDE + 1
  ldd r30, Y + UNIT_ADD
  ldd r31, Y + UNIT_ADD + 1
  add interval0, r30
  adc interval1, r31
  rjmp .Lfast
3:
  ldd interval0, Y + UNIT_WIDE
  ldd interval1, Y + UNIT_WIDE + 1
  ldd t0, Y + UNIT_WIDE + 2
  ldd t1, Y + UNIT_WIDE + 3
  ldd r30, Y + UNIT_ADD
  ldd r31, Y + UNIT_ADD + 1
  add interval0, r30
  adc interval1, r31
  adc t0, u0
  adc t1, u0
  sbrs r31, 7         // a negative add takes one more from the upper half
  rjmp .Lbegin_wide
  ldi r30, 1
  sub t0, r30
  sbc t1, u0
  rjmp .Lbegin_wide

#define STEP_FIXED(n, timer, unit, step_port, step_bit, dir_port, dir_bit) \
  STEP_INTERRUPT n, TIMER##timer##_COMP##unit##_vect, OCR##timer##unit##L, TCNT##timer##L, \
    TIFR##timer, TIMSK##timer, OCIE##timer##unit, 1, PIN##step_port, 1 << step_bit, \
    PIN##dir_port, 1 << dir_bit $
#define STEP_FREE(n, timer, unit) \
  STEP_INTERRUPT n, TIMER##timer##_COMP##unit##_vect, OCR##timer##unit##L, TCNT##timer##L, \
    TIFR##timer, TIMSK##timer, OCIE##timer##unit, 0, 0, 0, 0, 0 $

BOARD_FIXED(STEP_FIXED)
BOARD_FREE(STEP_FREE)
