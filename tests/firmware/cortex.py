"""A SAM3X8E made of an instruction-set simulator and the few modules that the firmware uses.

It is exact in what instructions do, not in how long they take: each counts as `_CYCLES` of the
core's clock, a look at the clock as `_LOOK`, and interrupts come between slices of instructions.
"""

from __future__ import annotations

import struct
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
    UC_CPU_ARM_CORTEX_M3,
)

CORE_HZ = 84_000_000
FLASH, RAM = 0x80000, 0x20070000
_SLICE, _CYCLES, _LOOK = 30, 1.5, 6
_EXC_RETURN = 0xFFFFFFF9
_IT_STATE = 0x0600FC00
_PENDSV, _SYSTICK, _UART = 14, 15, 16 + 8
_STACKED = (
    *(UC_ARM_REG_R0, UC_ARM_REG_R1, UC_ARM_REG_R2, UC_ARM_REG_R3, UC_ARM_REG_R12),
    UC_ARM_REG_LR,
)


class Sam3x8e:
    """The chip with an image in its flash. `edges` are (clock, pin, level), pins counted 32 a port;
    `analog` is what the converter's channels see."""

    def __init__(self, image: bytes) -> None:
        self.cycles = 0.0
        self.received: deque[int] = deque()
        self.sent = bytearray()
        self.edges: list[tuple[int, int, int]] = []
        self.levels: dict[int, int] = {}
        self.inputs: dict[int, int] = {}
        self.analog: dict[int, int] = {}
        self.duties: dict[int, int] = {}
        self.resets = 0
        self._channels = self._converted = 0
        self._peripheral = 0xFFFFFFFF
        self._sending = False
        self._alarm_load, self._alarm_at = 0, 0.0
        self._alarm_on = False
        self._priority = {_SYSTICK: 0, _UART: 0xFF, _PENDSV: 0}
        self._enabled = False
        self._pending: set[int] = set()
        self._active: list[int] = []
        uc = self._uc = Uc(UC_ARCH_ARM, UC_MODE_THUMB | UC_MODE_MCLASS)
        uc.ctl_set_cpu_model(UC_CPU_ARM_CORTEX_M3)
        uc.mem_map(FLASH, 0x80000)
        uc.mem_map(RAM, 0x18000)
        uc.mem_write(FLASH, image)
        for base, size, read, write in (
            (0x40080000, 0x1000, self._read_timer, self._write_nothing),
            (0x40094000, 0x1000, self._read_nothing, self._write_pwm),
            (0x400C0000, 0x1000, self._read_converter, self._write_converter),
            (0x400E0000, 0x2000, self._read_system, self._write_system),
            (0xE000E000, 0x1000, self._read_nothing, self._write_core),
        ):
            uc.mmio_map(base, size, read, None, write, None)
        uc.hook_add(UC_HOOK_INTR, self._interrupt)
        self._returned = False
        self._power_on()

    def _power_on(self) -> None:
        stack, self._pc = struct.unpack("<II", self._uc.mem_read(FLASH, 8))
        self._uc.reg_write(UC_ARM_REG_SP, stack)
        self._uc.reg_write(UC_ARM_REG_PRIMASK, 0)
        self._pending.clear()
        self._active.clear()

    @property
    def clock(self) -> int:
        """Ticks of the firmware's clock."""
        return int(self.cycles / 2)

    def run(self, seconds: float) -> None:
        """Lets time pass."""
        end = self.cycles + seconds * CORE_HZ
        while self.cycles < end:
            self._raise_interrupts()
            self._enter_one()
            self._returned = False
            self._uc.emu_start(self._pc | 1, 0xFFFFFFFF, count=_SLICE)
            self._pc = self._uc.reg_read(UC_ARM_REG_PC)
            self.cycles += _SLICE * _CYCLES
            if self._returned:
                self._leave()

    def _raise_interrupts(self) -> None:
        if self._alarm_on and self.cycles >= self._alarm_at:
            self._pending.add(_SYSTICK)
            self._alarm_at += max(self._alarm_load, 1)
        if self._enabled and (self.received or self._sending):
            self._pending.add(_UART)

    def _enter_one(self) -> None:
        if not self._pending or self._uc.reg_read(UC_ARM_REG_PRIMASK):
            return
        first = min(self._pending, key=lambda it: self._priority[it])
        running = min((self._priority[it] for it in self._active), default=0x100)
        if self._priority[first] >= running:
            return
        while self._uc.reg_read(UC_ARM_REG_XPSR) & _IT_STATE:
            self._uc.emu_start(self._pc | 1, 0xFFFFFFFF, count=1)
            self._pc = self._uc.reg_read(UC_ARM_REG_PC)
            self.cycles += _CYCLES
        uc = self._uc
        stack = uc.reg_read(UC_ARM_REG_SP) - 32
        saved = [uc.reg_read(register) for register in _STACKED]
        frame = struct.pack("<8I", *saved, self._pc, uc.reg_read(UC_ARM_REG_XPSR))
        uc.mem_write(stack, frame)
        uc.reg_write(UC_ARM_REG_SP, stack)
        uc.reg_write(UC_ARM_REG_LR, _EXC_RETURN)
        (self._pc,) = struct.unpack("<I", uc.mem_read(FLASH + 4 * first, 4))
        self._pending.discard(first)
        self._active.append(first)
        self.cycles += 12

    def _leave(self) -> None:
        uc = self._uc
        stack = uc.reg_read(UC_ARM_REG_SP)
        values = struct.unpack("<8I", uc.mem_read(stack, 32))
        for register, value in zip(_STACKED, values[:6], strict=True):
            uc.reg_write(register, value)
        uc.reg_write(UC_ARM_REG_SP, stack + 32)
        uc.reg_write(UC_ARM_REG_XPSR, values[7])
        self._pc = values[6]
        self._active.pop()
        self.cycles += 10

    def _interrupt(self, uc: Uc, number: int, _: Any) -> None:
        if number != 8:
            raise AssertionError(f"exception {number} at {uc.reg_read(UC_ARM_REG_PC):#x}")
        self._returned = True
        uc.emu_stop()

    def _read_nothing(self, *_: Any) -> int:
        return 0

    def _write_nothing(self, *_: Any) -> None:
        pass

    def _read_timer(self, uc: Uc, offset: int, size: int, _: Any) -> int:
        self.cycles += _LOOK
        return self.clock & 0xFFFFFFFF if offset == 0x10 else 0

    def _read_converter(self, uc: Uc, offset: int, size: int, _: Any) -> int:
        if offset == 0x20:
            return self.analog.get(self._channels.bit_length() - 1, 0)
        return 1 << 24 if offset == 0x30 and self.cycles >= self._converted else 0

    def _write_converter(self, uc: Uc, offset: int, size: int, value: int, _: Any) -> None:
        if offset == 0x10:
            self._channels |= value
        elif offset == 0x14:
            self._channels &= ~value
        elif offset == 0 and value & 2:
            self._converted = self.cycles + 20e-6 * CORE_HZ

    def _write_pwm(self, uc: Uc, offset: int, size: int, value: int, _: Any) -> None:
        channel, register = divmod(offset - 0x200, 0x20)
        if offset >= 0x200 and register in (4, 8):
            self.duties[channel] = value

    def _read_system(self, uc: Uc, offset: int, size: int, _: Any) -> int:
        if offset == 0x668:  # PMC_SR: all oscillators are steady
            return 0xFFFFFFFF
        if offset == 0x814:
            return 2 | bool(self.received)
        if offset == 0x818:
            return self.received.popleft() if self.received else 0
        if 0xE00 <= offset < 0x1600 and offset % 0x200 == 0x3C:
            port = (offset - 0xE00) // 0x200
            return sum(level << pin % 32 for pin, level in self.inputs.items() if pin // 32 == port)
        return 0

    def _write_system(self, uc: Uc, offset: int, size: int, value: int, _: Any) -> None:
        if offset == 0x81C:
            self.sent.append(value & 0xFF)
        elif offset in (0x808, 0x80C) and value & 2:
            self._sending = offset == 0x808
        elif offset == 0x1A00 and value == 0xA5000005:
            self.resets += 1
            uc.emu_stop()
        elif 0xE00 <= offset < 0x1600 and offset % 0x200 in (0x30, 0x34):
            self._drive((offset - 0xE00) // 0x200, value, int(offset % 0x200 == 0x30))

    def _drive(self, port: int, mask: int, level: int) -> None:
        for bit in range(32):
            pin = port * 32 + bit
            if mask >> bit & 1 and self.levels.get(pin) != level:
                self.levels[pin] = level
                self.edges.append((self.clock, pin, level))

    def _write_core(self, uc: Uc, offset: int, size: int, value: int, _: Any) -> None:
        if offset == 0x10:
            self._alarm_on = bool(value & 1)
            self._alarm_at = self.cycles + self._alarm_load
        elif offset == 0x14:
            self._alarm_load = value
        elif offset == 0x18:
            self._alarm_at = self.cycles + self._alarm_load
        elif offset == 0x100:
            self._enabled = bool(value & 1 << 8)
        elif offset == 0x408:
            self._priority[_UART] = value & 0xFF
        elif offset == 0xD04:
            self._pending |= {it for it, bit in ((_SYSTICK, 26), (_PENDSV, 28)) if value >> bit & 1}
        elif offset == 0xD20:
            self._priority[_PENDSV], self._priority[_SYSTICK] = value >> 16 & 0xFF, value >> 24
