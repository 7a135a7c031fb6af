"""What the firmware uses of each family of Cortex-M chips, as the data sheets describe it."""

from __future__ import annotations

import struct

from unicorn.arm_const import UC_CPU_ARM_CORTEX_M0, UC_CPU_ARM_CORTEX_M3, UC_CPU_ARM_CORTEX_M4

from .cortex import Cortex


class Sam3x8e(Cortex):
    """RADDS, RAMPS-FD, Duet 0.6."""

    CORE_HZ, CLOCK_HZ = 84_000_000, 42_000_000
    CPU = UC_CPU_ARM_CORTEX_M3
    FLASH, RAM = 0x80000, (0x20070000, 0x18000)
    MODULES: tuple[tuple[int, int], ...] = (
        *((0x40080000, 0x1000), (0x40094000, 0x1000), (0x400C0000, 0x1000), (0x400E0000, 0x2000)),
    )
    UART_IRQ = 8
    PWM, ADC, ADC_STATUS, ADC_READY = 0x40094000, 0x400C0000, 0x400C0030, 24
    POWER, UART, PORTS, PORT_COUNT = 0x400E0600, 0x400E0800, 0x400E0E00, 4
    RESET, WATCHDOG = 0x400E1A00, 0x400E1A50

    def __init__(self, image: bytes) -> None:
        self._channels, self._done = 0, 0.0
        self._not_pulled: set[int] = set()  # all are after a reset
        super().__init__(image)

    def read(self, address: int, size: int) -> int | None:
        port, register = divmod(address - self.PORTS, 0x200)
        if address == 0x40080010:
            return self.look()
        if address == self.POWER + 0x68:  # all oscillators are steady
            return 0xFFFFFFFF
        if address == self.UART + 0x14:
            return 2 | bool(self.received)
        if address == self.UART + 0x18:
            return self.received.popleft() if self.received else 0
        if address == self.ADC + 0x20:
            return self.analog.get(self._channels.bit_length() - 1, 0)
        if address == self.ADC_STATUS:
            return 1 << self.ADC_READY if self.cycles >= self._done else 0
        if 0 <= port < self.PORT_COUNT and register == 0x3C:
            return self.levels_in(port)
        return super().read(address, size)

    def write(self, address: int, value: int) -> None:
        port, register = divmod(address - self.PORTS, 0x200)
        if address == self.UART + 0x1C:
            self.sent.append(value & 0xFF)
        elif address in (self.UART + 8, self.UART + 12) and value & 2:
            self.sending = address == self.UART + 8
        elif address == self.RESET and value == 0xA5000005:
            self.start_anew()
        elif address == self.WATCHDOG and value == 0xA5000001:
            self.fed += 1
        elif address == self.PWM + 4:  # channels that are on show in the status
            self.registers[self.PWM + 12] = self.registers.get(self.PWM + 12, 0) | value
        elif address == self.ADC + 0x10:
            self._channels |= value
        elif address == self.ADC + 0x14:
            self._channels &= ~value
        elif address == self.ADC and value & 2:
            assert self._channels.bit_count() == 1
            self._done = self.cycles + 20e-6 * self.CORE_HZ
        elif 0 <= port < self.PORT_COUNT and register in (0x30, 0x34):
            self.drive(port, value, int(register == 0x30))
        elif 0 <= port < self.PORT_COUNT and register in (0x60, 0x64):
            pins = {32 * port + bit for bit in range(32) if value >> bit & 1}
            self._not_pulled = (self._not_pulled | pins) - (pins if register == 0x64 else set())

    def pull(self, pin: int) -> int:
        return int(pin not in self._not_pulled)

    def pulse(self, timer: str, channel: str) -> tuple[float, float]:
        base = self.PWM + 0x200 + 0x20 * int(timer.removeprefix("PWM"))
        mode, duty, update, period = (self.registers.get(base + i, 0) for i in (0, 4, 8, 12))
        assert bool(mode & 1 << 9) == (channel == "H")
        on = update if base + 8 in self.registers else duty
        return on / period, period * 2 ** (mode & 15) / self.CORE_HZ

    @property
    def watchdog_s(self) -> float:
        """The time after which a board that hangs starts anew."""
        mode = self.registers[self.WATCHDOG + 4]
        assert mode >> 13 & 7 == 1 and mode >> 16 & 0xFFF == mode & 0xFFF  # resets all, is on
        return (mode & 0xFFF) / 256


class Sam3u4e(Sam3x8e):
    """4pi."""

    CORE_HZ = CLOCK_HZ = 96_000_000
    RAM = (0x20000000, 0x8000)
    MODULES = ((0x4008C000, 0x1000), (0x400A8000, 0x1000), (0x400E0000, 0x2000))
    PWM, ADC, ADC_STATUS, ADC_READY = 0x4008C000, 0x400A8000, 0x400A801C, 16
    POWER, UART, PORTS, PORT_COUNT = 0x400E0400, 0x400E0600, 0x400E0C00, 3
    RESET, WATCHDOG = 0x400E1200, 0x400E1250


class Stm32f4(Cortex):
    """Discovery boards; of their UARTS the one that `UART` says."""

    CORE_HZ, CLOCK_HZ = 168_000_000, 84_000_000
    CPU = UC_CPU_ARM_CORTEX_M4
    FLASH, RAM = 0x08000000, (0x20000000, 0x30000)
    MODULES = ((0x40000000, 0x24000),)
    UART, UART_IRQ = 0x40004800, 39
    TIMERS = {
        "TIM1": (0x40010000, 168e6),
        "TIM3": (0x40000400, 84e6),
        "TIM4": (0x40000800, 84e6),
        "TIM5": (0x40000C00, 84e6),
        "TIM8": (0x40010400, 168e6),
        "TIM9": (0x40014000, 168e6),
    }
    _ADCS = (0x40012000, 0x40012200)  # ADC1; ADC3, whose channels count from 100

    def __init__(self, image: bytes) -> None:
        self._done = 0.0
        self._converter = 0
        super().__init__(image)

    def read(self, address: int, size: int) -> int | None:
        kept = self.registers.get(address, 0)
        port, register = divmod(address - 0x40020000, 0x400)
        converter, part = address & ~0xFF, address & 0xFF
        if address == 0x40000024:
            return self.look()
        if address == 0x40023800:  # what is on is ready
            return kept | (kept & 0x01010001) << 1
        if address == 0x40023808:  # what is chosen is taken
            return kept | (kept & 3) << 2
        if address == self.UART:
            return 0xC0 | bool(self.received) << 5
        if address == self.UART + 4:
            return self.received.popleft() if self.received else 0
        if converter in self._ADCS and part == 0:
            return (self.cycles >= self._done and converter == self._converter) << 1
        if converter in self._ADCS and part == 0x4C:
            self._converter = 0
            return self.analog.get(
                100 * self._ADCS.index(converter) + self.registers[converter + 0x34], 0
            )
        if 0 <= port < 8 and register == 0x10:
            return self.levels_in(port)
        return super().read(address, size)

    def write(self, address: int, value: int) -> None:
        port, register = divmod(address - 0x40020000, 0x400)
        if address == self.UART + 4:
            self.sent.append(value & 0xFF)
        elif address == self.UART + 12:
            self.sending = bool(value & 1 << 7)
        elif address == 0x40003000 and value == 0xAAAA:
            self.fed += 1
        elif address & ~0xFF in self._ADCS and address & 0xFF == 8 and value & 1 << 30:
            self._converter = address & ~0xFF
            self._done = self.cycles + 492 / 21e6 * self.CORE_HZ
        elif 0 <= port < 8 and register == 0x18:
            self.drive(port, value & 0xFFFF, 1)
            self.drive(port, value >> 16, 0)

    def pull(self, pin: int) -> int:
        kept = self.registers.get(0x4002000C + 0x400 * (pin // 32), 0)
        return (0, 1, -1)[kept >> 2 * (pin % 32) & 3]

    def pulse(self, timer: str, channel: str) -> tuple[float, float]:
        base, hz = self.TIMERS[timer]
        n = int(channel) - 1
        registers = {i: self.registers.get(base + i, 0) for i in range(0, 0x48, 4)}
        mode = registers[0x18 + n // 2 * 4] >> n % 2 * 8 & 0xFF
        assert (mode, registers[0] & 1, registers[0x20] >> 4 * n & 3) == (0x68, 1, 1)
        if timer in ("TIM1", "TIM8"):  # their outputs are off as long as none says otherwise
            assert registers[0x44] & 1 << 15
        period = registers[0x2C] + 1
        return registers[0x34 + 4 * n] / period, period * (registers[0x28] + 1) / hz

    @property
    def watchdog_s(self) -> float:
        """The time after which a board that hangs starts anew."""
        divider = 4 << self.registers[0x40003004]
        return self.registers[0x40003008] * divider / 32_000


class Stm32f429(Stm32f4):
    """The Discovery board whose console is another UART."""

    UART, UART_IRQ = 0x40004400, 38


class Rp2040(Cortex):
    """Raspberry Pi Pico. The chip's ROM checks and starts the second stage of its loader."""

    CORE_HZ, CLOCK_HZ = 120_000_000, 12_000_000
    CPU = UC_CPU_ARM_CORTEX_M0
    FLASH, RAM = 0x10000000, (0x20000000, 0x42000)
    MODULES = ((0x18000000, 0x1000), (0x40000000, 0x70000), (0xD0000000, 0x1000))
    UART_IRQ = 20
    _BOOT = 0x20041F00
    _RESETS, _CLOCK = 0x4000C000, 0x4000803C

    def __init__(self, image: bytes) -> None:
        self._ready = 0.0
        super().__init__(image)

    def _power_on(self) -> None:
        boot = bytes(self.uc.mem_read(self.FLASH, 256))
        assert _crc32_mpeg2(boot[:252]) == struct.unpack("<I", boot[252:])[0]
        self.uc.mem_write(self._BOOT, boot)
        self.pc = self._BOOT
        self.registers[self._RESETS] = 0x1FFFFFF

    def read(self, address: int, size: int) -> int | None:
        kept = self.registers.get(address, 0)
        if address == 0x40054028:
            return self.look()
        if address == 0x40024004:  # the crystal is steady
            return 1 << 31
        if address in (0x40028000, 0x4002C000):  # locked
            return kept | 1 << 31
        if address in (0x40008038, 0x40008044):
            return 1 << (self.registers.get(address - 8, 0) & 3)
        if address == self._RESETS + 8:
            return ~self.registers[self._RESETS] & 0x1FFFFFF
        if address == 0x40034018:
            return (not self.received) << 4
        if address == 0x40034000:
            return self.received.popleft()
        if address == 0x4004C000:
            return kept | (self.cycles >= self._ready) << 8
        if address == 0x4004C004:
            return self.analog.get(self.registers[0x4004C000] >> 12 & 7, 0)
        if address == 0xD0000004:
            return self.levels_in(0)
        return super().read(address, size)

    def write(self, address: int, value: int) -> None:
        for base in (self._RESETS, self._CLOCK):
            if address == base + 0x2000:
                self.registers[base] |= value
            elif address == base + 0x3000:
                self.registers[base] = self.registers.get(base, 0) & ~value
        if address == 0x40034000:
            self.sent.append(value & 0xFF)
        elif address == 0x40034038:  # it interrupts when its queue has run empty, not while it is
            self.sending = False
        elif address == 0x40058004:
            self.fed += 1
        elif address == 0x40058000 and value == 1 << 31:
            self.start_anew()
        elif address == 0x4004C000 and value & 4:
            self._ready = self.cycles + 2e-6 * self.CORE_HZ
        elif address in (0xD0000014, 0xD0000018):
            self.drive(0, value, int(address == 0xD0000014))

    def pull(self, pin: int) -> int:
        pad = self.registers.get(0x4001C004 + 4 * pin, 0x56)
        return (pad >> 3 & 1) - (pad >> 2 & 1)

    def pulse(self, timer: str, channel: str) -> tuple[float, float]:
        base = 0x40050000 + 0x14 * int(timer.removeprefix("PWM"))
        control, divider, compare, top = (self.registers.get(base + i, 0) for i in (0, 4, 12, 16))
        assert control == 1
        on = compare >> 16 if channel == "B" else compare & 0xFFFF
        return on / (top + 1), (top + 1) * divider / 16 / self.CORE_HZ

    @property
    def watchdog_s(self) -> float:
        """The time after which a board that hangs starts anew."""
        assert self.registers[0x40058000] == 1 << 30 and self.registers[0x40010008] == 0x1FFFC
        assert self.registers[0x4005802C] == 1 << 9 | 1
        return self.registers[0x40058004] / 2 / 12e6


def _crc32_mpeg2(data: bytes) -> int:
    crc = 0xFFFFFFFF
    for i in range(8 * len(data)):
        top = crc >> 31 ^ data[i // 8] >> (7 - i % 8) & 1
        crc = (crc << 1 ^ 0x04C11DB7 * top) & 0xFFFFFFFF
    return crc


class Mk20dx256(Cortex):
    """Teensy 3.1 and 3.2."""

    CORE_HZ = CLOCK_HZ = 72_000_000
    BUS_HZ = 36_000_000
    CPU = UC_CPU_ARM_CORTEX_M4
    FLASH, RAM = 0, (0x1FFF8000, 0x10000)
    MODULES = ((0x40038000, 0x81000), (0x400FF000, 0x1000))
    UART_IRQ = 47
    TIMERS = {"FTM0": 0x40038000, "FTM1": 0x40039000, "FTM2": 0x400B8000}
    GATES = {"FTM0": (0x4004803C, 24), "FTM1": (0x4004803C, 25), "FTM2": (0x40048030, 24)}
    _UART, _CLOCK = 0x4006B000, 0x40064000

    def __init__(self, image: bytes) -> None:
        self._done = 0.0
        self.collides = False  # a byte overruns the next one between its status and itself
        self._overrun = self._seen = False
        super().__init__(image)

    def _mcg(self) -> int:
        c1, c2, c6 = (self.registers.get(self._CLOCK + i, 0) for i in (0, 1, 5))
        crystal = c2 >> 2 & 1
        pll = c6 >> 6 & 1
        source = c1 >> 6 or (3 if pll and c1 else 0)
        return crystal << 1 | source << 2 | (not c1) << 4 | pll << 5 | pll << 6

    def read(self, address: int, size: int) -> int | None:
        port, register = divmod(address - 0x400FF000, 0x40)
        if address == self._CLOCK + 6:
            return self._mcg()
        self._check_gate(address)
        if address == self._UART + 4:
            self._seen = self._overrun
            return 0xC0 | self._overrun << 3 | (bool(self.received) and not self._overrun) << 5
        if address == self._UART + 7:
            return self._take()
        if address == 0x4003B000:
            return self.registers.get(address, 0) | (self.cycles >= self._done) << 7
        if address == 0x4003B010:
            return self.analog.get(self.registers[0x4003B000] & 31, 0)
        if address == 0x4003B024:  # calibrated
            return self.registers.get(address, 0) & ~0x80
        if 0 <= port < 5 and register == 0x10:
            return self.levels_in(port)
        return super().read(address, size)

    def _check_gate(self, address: int) -> None:
        """A module whose clock is off answers with a bus fault."""
        for name, base in self.TIMERS.items():
            place, bit = self.GATES[name]
            if 0 <= address - base < 0x1000:
                assert self.registers.get(place, 0) >> bit & 1, f"{name} has no clock"

    def _take(self) -> int:
        """The data register: an overrun that the status did not show stays."""
        if self._overrun:
            self._overrun = not self._seen
            return 0
        self._overrun, self.collides = self.collides, False
        return self.received.popleft() if self.received else 0

    def write(self, address: int, value: int) -> None:
        self._check_gate(address)
        port, register = divmod(address - 0x400FF000, 0x40)
        if address == self._UART + 7:
            self.sent.append(value)
        elif address == self._UART + 3:
            self.sending = bool(value & 0x80)
        elif address == 0x4005200C:
            self.fed += value == 0xB480
        elif address == 0x4003B000:
            self._done = self.cycles + 40e-6 * self.CORE_HZ
        elif 0 <= port < 5 and register in (4, 8):
            self.drive(port, value, int(register == 4))

    def pull(self, pin: int) -> int:
        return (0, 0, -1, 1)[self.registers.get(_pad(pin), 0) & 3]

    def pulse(self, timer: str, channel: str) -> tuple[float, float]:
        base = self.TIMERS[timer]
        mode, value = (self.registers.get(base + 0xC + 8 * int(channel) + i, 0) for i in (0, 4))
        control, top = self.registers[base], self.registers[base + 8] + 1
        assert (mode, control >> 3) == (0x28, 1)
        return value / top, top * 2 ** (control & 7) / self.BUS_HZ

    @property
    def watchdog_s(self) -> float:
        """The time after which a board that hangs starts anew."""
        base = 0x40052000
        assert self.registers[base] & 0x0F == 1 and self.registers[base + 0x16] == 0
        assert self.registers[base + 0xE] == 0xD928
        return (self.registers[base + 4] << 16 | self.registers[base + 6]) / 1000


def _pad(pin: int) -> int:
    """The register PORTx_PCRn of a pin."""
    return 0x40049000 + 0x1000 * (pin // 32) + 4 * (pin % 32)


class Mk20dx128(Mk20dx256):
    """Teensy 3.0."""

    CORE_HZ = CLOCK_HZ = BUS_HZ = 48_000_000
    RAM = (0x1FFFE000, 0x4000)
    UART_IRQ = 18
