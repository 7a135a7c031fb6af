"""A Cortex-M core made of an instruction-set simulator; `chips` adds the modules of each chip.

It is exact in what instructions do, not in how long they take: each counts as `_CYCLES` of the
core's clock, a look at the clock as `_LOOK`, and interrupts come between slices of instructions.
Registers that no model knows keep what is written to them.
"""

from __future__ import annotations

import struct
from abc import ABC, abstractmethod
from collections import deque
from typing import Any

from unicorn import UC_ARCH_ARM, UC_HOOK_INTR, UC_MODE_MCLASS, UC_MODE_THUMB, Uc
from unicorn.arm_const import (
    UC_ARM_REG_LR,
    UC_ARM_REG_PC,
    UC_ARM_REG_PRIMASK,
    UC_ARM_REG_R0,
    UC_ARM_REG_R1,
    UC_ARM_REG_R2,
    UC_ARM_REG_R3,
    UC_ARM_REG_R12,
    UC_ARM_REG_SP,
    UC_ARM_REG_XPSR,
)

_SLICE, _CYCLES, _LOOK = 30, 1.5, 6
_EXC_RETURN = 0xFFFFFFF9
_IT_STATE = 0x0600FC00
_PENDSV, _SYSTICK, _EXTERNAL = 14, 15, 16
_SYSTEM, _DEBUG = 0xE000E000, 0xE0001000
_STACKED = (
    *(UC_ARM_REG_R0, UC_ARM_REG_R1, UC_ARM_REG_R2, UC_ARM_REG_R3, UC_ARM_REG_R12),
    UC_ARM_REG_LR,
)


class Cortex(ABC):
    """A chip with an image in its flash. `edges` are (clock, pin, level), pins counted 32 a port;
    `analog` is what the converter's channels see; `fed` counts what has been done to the
    watchdog."""

    CORE_HZ: int
    CLOCK_HZ: int
    CPU: int
    FLASH: int
    RAM: tuple[int, int]  # begin, size
    MODULES: tuple[tuple[int, int], ...]  # begin, size
    UART_IRQ: int
    vectors: int

    def __init__(self, image: bytes) -> None:
        self.cycles = 0.0
        self.received: deque[int] = deque()
        self.sent = bytearray()
        self.edges: list[tuple[int, int, int]] = []
        self.levels: dict[int, int] = {}
        self.inputs: dict[int, int] = {}
        self.analog: dict[int, int] = {}
        self.registers: dict[int, int] = {}
        self.resets = self.fed = 0
        self.sending = False
        self._alarm_load, self._alarm_at = 0, 0.0
        self._alarm_on = False
        self._uart = _EXTERNAL + self.UART_IRQ
        self._priority = {_SYSTICK: 0, self._uart: 0xFF, _PENDSV: 0}
        self._enabled = False
        self._pending: set[int] = set()
        self._active: list[int] = []
        uc = self.uc = Uc(UC_ARCH_ARM, UC_MODE_THUMB | UC_MODE_MCLASS)
        uc.ctl_set_cpu_model(self.CPU)
        uc.mem_map(self.FLASH, (len(image) + 0xFFF) & ~0xFFF)
        uc.mem_map(*self.RAM)
        uc.mem_write(self.FLASH, image)
        for base, size in (*self.MODULES, (_SYSTEM, 0x1000), (_DEBUG, 0x1000)):
            uc.mmio_map(base, size, self._read, base, self._write, base)
        uc.hook_add(UC_HOOK_INTR, self._interrupt)
        self._returned = False
        self.vectors = self.FLASH
        self._power_on()

    def _power_on(self) -> None:
        stack, self.pc = struct.unpack("<II", self.uc.mem_read(self.vectors, 8))
        self.uc.reg_write(UC_ARM_REG_SP, stack)
        self.uc.reg_write(UC_ARM_REG_PRIMASK, 0)

    @property
    def clock(self) -> int:
        """Ticks of the firmware's clock."""
        return int(self.cycles * self.CLOCK_HZ / self.CORE_HZ)

    def run(self, seconds: float) -> None:
        """Lets time pass."""
        end = self.cycles + seconds * self.CORE_HZ
        while self.cycles < end:
            self._raise_interrupts()
            self._enter_one()
            self._returned = False
            self.uc.emu_start(self.pc | 1, 0xFFFFFFFF, count=_SLICE)
            self.pc = self.uc.reg_read(UC_ARM_REG_PC)
            self.cycles += _SLICE * _CYCLES
            if self._returned:
                self._leave()

    def _raise_interrupts(self) -> None:
        if self._alarm_on and self.cycles >= self._alarm_at:
            self._pending.add(_SYSTICK)
            self._alarm_at += max(self._alarm_load, 1)
        if self._enabled and (self.received or self.sending):
            self._pending.add(self._uart)

    def _enter_one(self) -> None:
        if not self._pending or self.uc.reg_read(UC_ARM_REG_PRIMASK):
            return
        first = min(self._pending, key=lambda it: self._priority[it])
        running = min((self._priority[it] for it in self._active), default=0x100)
        if self._priority[first] >= running:
            return
        while self.uc.reg_read(UC_ARM_REG_XPSR) & _IT_STATE:
            self.uc.emu_start(self.pc | 1, 0xFFFFFFFF, count=1)
            self.pc = self.uc.reg_read(UC_ARM_REG_PC)
            self.cycles += _CYCLES
        uc = self.uc
        stack = uc.reg_read(UC_ARM_REG_SP) - 32
        saved = [uc.reg_read(register) for register in _STACKED]
        frame = struct.pack("<8I", *saved, self.pc, uc.reg_read(UC_ARM_REG_XPSR))
        uc.mem_write(stack, frame)
        uc.reg_write(UC_ARM_REG_SP, stack)
        uc.reg_write(UC_ARM_REG_LR, _EXC_RETURN)
        (self.pc,) = struct.unpack("<I", uc.mem_read(self.vectors + 4 * first, 4))
        self._pending.discard(first)
        self._active.append(first)
        self.cycles += 12

    def _leave(self) -> None:
        uc = self.uc
        stack = uc.reg_read(UC_ARM_REG_SP)
        values = struct.unpack("<8I", uc.mem_read(stack, 32))
        for register, value in zip(_STACKED, values[:6], strict=True):
            uc.reg_write(register, value)
        uc.reg_write(UC_ARM_REG_SP, stack + 32)
        uc.reg_write(UC_ARM_REG_XPSR, values[7])
        self.pc = values[6]
        self._active.pop()
        self.cycles += 10

    def _interrupt(self, uc: Uc, number: int, _: Any) -> None:
        if number != 8:
            raise AssertionError(f"exception {number} at {uc.reg_read(UC_ARM_REG_PC):#x}")
        self._returned = True
        uc.emu_stop()

    def _read(self, _: Uc, offset: int, size: int, base: int) -> int:
        value = self.read(base + offset, size)
        return self.registers.get(base + offset, 0) if value is None else value

    def _write(self, _: Uc, offset: int, size: int, value: int, base: int) -> None:
        self.registers[base + offset] = value
        if base == _SYSTEM:
            self._write_core(offset, value)
        else:
            self.write(base + offset, value)

    def read(self, address: int, size: int) -> int | None:
        """What a module's register says; None if it keeps what is written to it."""
        if address == _DEBUG + 4:  # the counter of cycles
            return self.look()
        return None

    @abstractmethod
    def write(self, address: int, value: int) -> None:
        """What a write to a module's register does, besides being kept."""

    def look(self) -> int:
        """The firmware looks at its clock."""
        self.cycles += _LOOK
        return self.clock & 0xFFFFFFFF

    def start_anew(self) -> None:
        """The firmware asks for a reset."""
        self.resets += 1
        self.uc.emu_stop()

    def drive(self, port: int, mask: int, level: int) -> None:
        """Outputs of a port get a level."""
        for bit in range(32):
            pin = port * 32 + bit
            if mask >> bit & 1 and self.levels.get(pin) != level:
                self.levels[pin] = level
                self.edges.append((self.clock, pin, level))

    def levels_in(self, port: int) -> int:
        """The inputs of a port that are high."""
        return sum(level << pin % 32 for pin, level in self.inputs.items() if pin // 32 == port)

    @abstractmethod
    def pull(self, pin: int) -> int:
        """1 if the chip pulls a pin up, -1 if down, 0 if it does not."""

    @abstractmethod
    def pulse(self, timer: str, channel: str) -> tuple[float, float]:
        """The share of its cycle that an output is on, and the cycle in seconds."""

    def _write_core(self, offset: int, value: int) -> None:
        if offset == 0x10:
            self._alarm_on = bool(value & 1)
            self._alarm_at = self.cycles + self._alarm_load
        elif offset == 0x14:
            self._alarm_load = value
        elif offset == 0x18:
            self._alarm_at = self.cycles + self._alarm_load
        elif offset == 0x100 + self.UART_IRQ // 32 * 4:
            self._enabled = bool(value >> self.UART_IRQ % 32 & 1)
        elif offset == 0x200 + self.UART_IRQ // 32 * 4:
            assert value == 1 << self.UART_IRQ % 32
            self._pending.add(self._uart)
        elif offset == 0x400 + self.UART_IRQ // 4 * 4:
            self._priority[self._uart] = value >> self.UART_IRQ % 4 * 8 & 0xFF
        elif offset == 0xD04:
            self._pending |= {it for it, bit in ((_SYSTICK, 26), (_PENDSV, 28)) if value >> bit & 1}
        elif offset == 0xD08:
            self.vectors = value
        elif offset == 0xD0C:
            assert value == 0x05FA0004
            self.start_anew()
        elif offset == 0xD20:
            self._priority[_PENDSV], self._priority[_SYSTICK] = value >> 16 & 0xFF, value >> 24
