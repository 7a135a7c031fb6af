// The second stage of the chip's loader: what its ROM copies from the flash's first 256 bytes into
// RAM and starts, if the sum that the build puts into their last four is right. It has the flash
// read with the one command that all flashes know (03h, at a fourth of the clock), copies the image
// behind it into RAM, where no step waits for a word of flash, and starts it there.
  .syntax unified
  .cpu cortex-m0plus
  .thumb

#define SSI 0x18000000  // the flash's serial interface
#define CTRLR0 0x00
#define CTRLR1 0x04
#define SSIENR 0x08
#define BAUDR 0x14
#define SPI_CTRLR0 0xF4
#define SCB_VTOR 0xE000ED08

  .section .boot, "ax", %progbits
  .balign 4
boot:
  ldr r0, =SSI
  movs r1, #0
  str r1, [r0, #SSIENR]
  movs r1, #4
  str r1, [r0, #BAUDR]
  ldr r1, =(3 << 8 | 31 << 16)  // command, then read; words of 32 bits; one line each way
  str r1, [r0, #CTRLR0]
  movs r1, #0                   // one word a read
  str r1, [r0, #CTRLR1]
  ldr r1, =(3 << 24 | 2 << 8 | 6 << 2)  // command 03h of 8 bits, address of 24 bits, no pause
  movs r2, #SPI_CTRLR0
  str r1, [r0, r2]
  movs r1, #1
  str r1, [r0, #SSIENR]
  ldr r0, =code_load
  ldr r1, =code_begin
  ldr r2, =code_end
copy:
  ldmia r0!, {r3}
  stmia r1!, {r3}
  cmp r1, r2
  blo copy
  ldr r0, =vectors
  ldr r1, =SCB_VTOR
  str r0, [r1]
  ldmia r0!, {r1, r2}
  msr msp, r1
  bx r2
  .ltorg
  .space 252 - (. - boot), 0
  .word 0  // the sum
