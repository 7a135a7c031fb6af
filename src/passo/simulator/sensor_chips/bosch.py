"""Simulated chips of Bosch: their registers, by the integer formulas of the data sheets."""

from __future__ import annotations

import struct
from abc import abstractmethod
from collections.abc import Callable

from passo.board.i2c_sensors.bosch_chips import bmp180
from passo.simulator.sensor_chips.chip import SensorChip

_IDENTITIES = {"bmp180": 0x55, "bmp280": 0x58, "bme280": 0x60, "bme680": 0x61}
# Calibrations: of the examples in the data sheets of BMP180 and BMP280, of a BME280 and a BME680.
_BMP180 = (408, -72, -14383, 32741, 32757, 23153, 6190, 4, -32768, -8711, 2868)
_BMP280 = (27504, 26435, -1000, 36477, -10685, 3024, 2855, 140, -7, 15500, -14600, 6000)
_BME280 = (75, 362, 0, 313, 50, 30)
_BME680_T = (26203, 26519, 3)
_BME680_P = (35008, -10284, 88, 9692, -202, 30, 24, -516, -3469, 30)
_BME680_H = (794, 1007, 0, 45, 20, 120, -100)


def _raw(value_of: Callable[[int], float], wanted: float, bits: int) -> int:
    """The reading of so many bits for which a rising or falling function is near `wanted`."""
    low, high = 0, (1 << bits) - 1
    rises = value_of(high) > value_of(low)
    while low < high:
        middle = (low + high) // 2
        if (value_of(middle) >= wanted) == rises:
            high = middle
        else:
            low = middle + 1
    return low


class _Registers(SensorChip):
    """A chip with registers. A read takes the selected register and those behind it. A measurement
    takes `_seconds`."""

    _seconds = 0.017

    def __init__(self, clock_hz: float, kind: str) -> None:
        super().__init__(clock_hz)
        self._kind = kind
        self.registers = bytearray(256)
        self.registers[0xD0] = _IDENTITIES[kind]
        self._pointer, self._ready = 0, 0

    def command(self, data: bytes, clock: int) -> None:
        """Selects a register, and writes it."""
        self._pointer = data[0]
        for register, value in zip(data[::2], data[1::2], strict=False):
            if register != 0xE0:
                self.registers[register] = value
            self.written(register, value, clock)

    def answer(self, clock: int) -> bytes | None:
        """The registers from the selected one on."""
        self.show(busy=clock < self._ready)
        return bytes(self.registers[self._pointer :])

    def _put(self, at: int, data: bytes) -> None:
        self.registers[at : at + len(data)] = data

    def _put_20(self, at: int, raw: int) -> None:
        self._put(at, (raw << 4).to_bytes(3, "big"))

    @abstractmethod
    def written(self, register: int, value: int, clock: int) -> None:
        """A register was written."""

    @abstractmethod
    def show(self, *, busy: bool) -> None:
        """Sets the status before a read."""


class BMP180(_Registers):
    """A BMP180: one measurement of the temperature or the pressure for each command."""

    def __init__(self, clock_hz: float) -> None:
        super().__init__(clock_hz, "bmp180")
        self._put(0xAA, struct.pack(">3h3H5h", *_BMP180))

    def written(self, register: int, value: int, clock: int) -> None:
        """A measurement: 0x2E of the temperature, 0x34 of the pressure, with the oversampling."""
        if register != 0xF4:
            return
        dig = _BMP180
        warm = _raw(lambda raw: bmp180(dig, raw, 0, 0).celsius, self.celsius, 16)
        if value == 0x2E:
            self._ready = self.after(clock, 0.0045)
            self._put(0xF6, warm.to_bytes(2, "big"))
            return
        times = value >> 6
        self._ready = self.after(clock, (0.0045, 0.0075, 0.0135, 0.0255)[times])
        raw = _raw(
            lambda raw: bmp180(dig, warm, raw, times).pressure_hpa or 0.0,
            self.pressure_hpa,
            16 + times,
        )
        self._put(0xF6, (raw << 8 - times).to_bytes(3, "big"))

    def show(self, *, busy: bool) -> None:
        """While the chip measures, the result is that of before: 0 here."""
        if busy:
            self._put(0xF6, bytes(3))


class BoschChip(_Registers):
    """A BMP280, BME280 or BME680, which measures once for each command."""

    def __init__(self, clock_hz: float, kind: str) -> None:
        super().__init__(clock_hz, kind)
        if kind == "bme680":
            t, p, h = _BME680_T, _BME680_P, _BME680_H
            words = (t[1], t[2], *p[:5], p[6], p[5], *p[7:])
            self._put(0x8A, struct.pack("<hbxHhbxhhbb2xhhB", *words))
            head = bytes((h[1] >> 4, (h[1] & 15) << 4 | h[0] & 15, h[0] >> 4))
            self._put(0xE1, head + struct.pack("<3bBbH", *h[2:], t[0]))
            return
        self._put(0x88, struct.pack("<H2hH8h", *_BMP280))
        if kind == "bme280":
            h1, h2, h3, h4, h5, h6 = _BME280
            self.registers[0xA1] = h1
            middle = bytes((h4 >> 4, (h5 & 15) << 4 | h4 & 15, h5 >> 4))
            self._put(0xE1, struct.pack("<hB", h2, h3) + middle + struct.pack("b", h6))

    @property
    def _of_680(self) -> bool:
        return self._kind == "bme680"

    def written(self, register: int, value: int, clock: int) -> None:
        """A measurement, if the mode is a forced one."""
        if register != (0x74 if self._of_680 else 0xF4) or value & 3 != 1:
            return
        self._ready = self.after(clock, self._seconds)
        celsius_of = self._celsius_680 if self._of_680 else self._celsius_280
        warm = _raw(lambda raw: celsius_of(raw) / 5120, self.celsius, 20)
        fine = celsius_of(warm)
        pascal_of = _pascal_680 if self._of_680 else _pascal_280
        pressed = _raw(lambda raw: pascal_of(raw, fine), self.pressure_hpa * 100, 20)
        at = 0x1F if self._of_680 else 0xF7
        self._put_20(at, pressed)
        self._put_20(at + 3, warm)
        if self._kind != "bmp280":
            damp_of = _damp_680 if self._of_680 else _damp_280
            self._put(
                at + 6, _raw(lambda raw: damp_of(raw, fine), self.humidity, 16).to_bytes(2, "big")
            )

    def show(self, *, busy: bool) -> None:
        """The status: a BME680 reports new data, the others that they measure."""
        if self._of_680:
            self.registers[0x1D] = 0 if busy or not self._ready else 0x80
        else:
            self.registers[0xF3] = 0x08 if busy else 0

    @staticmethod
    def _celsius_280(raw: int) -> int:
        t1, t2, t3 = _BMP280[:3]
        near = (raw >> 4) - t1
        return (((raw >> 3) - (t1 << 1)) * t2 >> 11) + ((near * near >> 12) * t3 >> 14)

    @staticmethod
    def _celsius_680(raw: int) -> int:
        t1, t2, t3 = _BME680_T
        near = (raw >> 3) - (t1 << 1)
        return (near * t2 >> 11) + (((near >> 1) ** 2 >> 12) * (t3 << 4) >> 14)


def _pascal_280(raw: int, fine: int) -> float:
    p1, p2, p3, p4, p5, p6, p7, p8, p9 = _BMP280[3:]
    x = fine - 128000
    y = x * x * p6 + (x * p5 << 17) + (p4 << 35)
    x = (x * x * p3 >> 8) + (x * p2 << 12)
    x = ((1 << 47) + x) * p1 >> 33
    p = ((1048576 - raw << 31) - y) * 3125 // x
    further = (p9 * (p >> 13) * (p >> 13) >> 25) + (p8 * p >> 19)
    return ((p + further >> 8) + (p7 << 4)) / 256


def _damp_280(raw: int, fine: int) -> float:
    h1, h2, h3, h4, h5, h6 = _BME280
    x = fine - 76800
    y = ((raw << 14) - (h4 << 20) - h5 * x + 16384 >> 15) * (
        (((x * h6 >> 10) * ((x * h3 >> 11) + 32768) >> 10) + 2097152) * h2 + 8192 >> 14
    )
    y -= ((y >> 15) * (y >> 15) >> 7) * h1 >> 4
    return min(max(y, 0), 419430400) / 4096 / 1024


def _pascal_680(raw: int, fine: int) -> float:
    p1, p2, p3, p4, p5, p6, p7, p8, p9, p10 = _BME680_P
    x = (fine >> 1) - 64000
    y = ((x >> 2) ** 2 >> 11) * p6 >> 2
    y = (y + (x * p5 << 1) >> 2) + (p4 << 16)
    x = ((((x >> 2) ** 2 >> 13) * (p3 << 5) >> 3) + (p2 * x >> 1)) >> 18
    x = (32768 + x) * p1 >> 15
    p = (1048576 - raw - (y >> 12)) * 3125 * 2 // x
    further = (
        (p9 * ((p >> 3) ** 2 >> 13) >> 12) + ((p >> 2) * p8 >> 13) + ((p >> 8) ** 3 * p10 >> 17)
    )
    return p + (further + (p7 << 7) >> 4)


def _damp_680(raw: int, fine: int) -> float:
    h1, h2, h3, h4, h5, h6, h7 = _BME680_H
    t = fine * 5 + 128 >> 8  # 0.01 °C
    x = raw - (h1 << 4) - (t * h3 // 100 >> 1)
    y = h2 * ((t * h4 // 100) + ((t * (t * h5 // 100) >> 6) // 100) + (1 << 14)) >> 10
    z = x * y
    more = (h6 << 7) + t * h7 // 100 >> 4
    z += more * ((z >> 14) ** 2 >> 10) >> 1
    return min(max((z >> 10) * 1000 >> 12, 0), 100_000) / 1000
