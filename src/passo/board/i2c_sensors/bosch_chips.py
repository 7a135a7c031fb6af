"""Bosch's sensors of temperature, pressure and humidity. The chip reports which one it is, and its
calibration, from which the formulas of its data sheet give the measurement."""

from __future__ import annotations

import struct
from collections.abc import Generator, Iterable

from passo.board.i2c_sensors.exchanges import ChipError, Measured, Steps, Transfer

_ID, _RESET = 0xD0, b"\xe0\xb6"
_BMP180, _BME280, _BME680 = 0x55, 0x60, 0x61
_BMP280 = (0x56, 0x57, 0x58)
_START_S, _MEASURE_S, _TRIES = 0.02, 0.05, 5
_OVERSAMPLING = 3  # of the pressure of a BMP180: 2³ samples
# Twofold oversampling of everything, and one measurement.
_DAMP, _FORCED = b"\x02", b"\x49"


def read_bosch() -> Steps:
    """Reads such a chip. It measures once for each measurement, and rests in between."""
    chip = (yield Transfer(bytes((_ID,)), 1))[0]
    if chip not in (_BMP180, *_BMP280, _BME280, _BME680):
        raise ChipError("other-chip", f"the identity 0x{chip:02x}")
    yield Transfer(_RESET)
    yield _START_S
    if chip == _BMP180:
        yield from _read_bmp180()
    elif chip == _BME680:
        yield from _read_bme680()
    else:
        yield from _read_bme280(humid=chip == _BME280)


def _read_bmp180() -> Steps:
    dig = struct.unpack(">3h3H5h", (yield Transfer(b"\xaa", 22)))
    while True:
        yield Transfer(b"\xf4\x2e")
        yield 0.01
        warm = int.from_bytes((yield Transfer(b"\xf6", 2)), "big")
        yield Transfer(bytes((0xF4, 0x34 | _OVERSAMPLING << 6)))
        yield 0.03
        pressed = int.from_bytes((yield Transfer(b"\xf6", 3)), "big") >> 8 - _OVERSAMPLING
        yield bmp180(dig, warm, pressed, _OVERSAMPLING)


def _read_bme280(*, humid: bool) -> Steps:
    dig = struct.unpack("<H2hH8h", (yield Transfer(b"\x88", 24)))
    damp_dig: tuple[int, ...] = ()
    if humid:
        first = yield Transfer(b"\xa1", 1)
        h2, h3, *rest, h6 = struct.unpack("<hB3Bb", (yield Transfer(b"\xe1", 7)))
        h4, h5 = rest[0] << 4 | rest[1] & 0x0F, rest[2] << 4 | rest[1] >> 4
        damp_dig = (first[0], h2, h3, _signed(h4, 12), _signed(h5, 12), h6)
    while True:
        if humid:
            yield Transfer(b"\xf2" + _DAMP)
        yield Transfer(b"\xf4" + _FORCED)
        yield from _wait_for(0xF3, 0x08, 0x00)
        data = yield Transfer(b"\xf7", 8 if humid else 6)
        pressed, warm = _raw_20(data[0:3]), _raw_20(data[3:6])
        yield bme280(dig, damp_dig, warm, pressed, int.from_bytes(data[6:8], "big"))


def _read_bme680() -> Steps:
    low = yield Transfer(b"\x8a", 23)
    high = yield Transfer(b"\xe1", 10)
    t2, t3, p1, p2, p3, p4, p5, p7, p6, p8, p9, p10 = struct.unpack("<hbxHhbxhhbb2xhhB", low)
    h1, h2 = high[2] << 4 | high[1] & 0x0F, high[0] << 4 | high[1] >> 4
    h3, h4, h5, h6, h7, t1 = struct.unpack("<3bBbH", high[3:])
    while True:
        yield Transfer(b"\x72" + _DAMP)
        yield Transfer(b"\x74" + _FORCED)
        yield from _wait_for(0x1D, 0x80, 0x80)
        data = yield Transfer(b"\x1f", 8)
        yield bme680(
            (t1, t2, t3),
            (p1, p2, p3, p4, p5, p6, p7, p8, p9, p10),
            (h1, h2, h3, h4, h5, h6, h7),
            (_raw_20(data[3:6]), _raw_20(data[0:3]), int.from_bytes(data[6:8], "big")),
        )


def _wait_for(register: int, mask: int, value: int) -> Generator[Transfer | float, bytes, None]:
    """Waits until these bits of a register have a value."""
    for _ in range(_TRIES):
        yield _MEASURE_S
        if (yield Transfer(bytes((register,)), 1))[0] & mask == value:
            return
    raise ChipError("silent", "a measurement that does not end")


def _raw_20(data: bytes) -> int:
    return int.from_bytes(data, "big") >> 4


def _signed(value: int, bits: int) -> int:
    return value - (1 << bits) if value >> (bits - 1) else value


def bmp180(dig: tuple[int, ...], warm: int, pressed: int, oversampling: int) -> Measured:
    """The measurement of a BMP180 (BST-BMP180-DS000-09, 3.5), whose formulas are in integers."""
    ac1, ac2, ac3, ac4, ac5, ac6, b1, b2, _, mc, md = dig
    x1 = (warm - ac6) * ac5 >> 15
    b5 = x1 + int(mc * 2048 / (x1 + md))
    b6 = b5 - 4000
    x3 = (b2 * (b6 * b6 >> 12) >> 11) + (ac2 * b6 >> 11)
    b3 = ((ac1 * 4 + x3 << oversampling) + 2) // 4
    x3 = (ac3 * b6 >> 13) + (b1 * (b6 * b6 >> 12) >> 16) + 2 >> 2
    b4 = ac4 * (x3 + 32768) >> 15
    b7 = (pressed - b3) * (50000 >> oversampling)
    p = b7 * 2 // b4
    x1 = (p >> 8) * (p >> 8) * 3038 >> 16
    p += x1 + (-7357 * p >> 16) + 3791 >> 4
    return Measured((b5 + 8 >> 4) / 10, None, p / 100)


def bme280(
    dig: tuple[int, ...], damp_dig: tuple[int, ...], warm: int, pressed: int, damp: int
) -> Measured:
    """The measurement of a BMP280 or, with `damp_dig`, of a BME280 (BST-BME280-DS002, 8.1)."""
    t1, t2, t3, p1, *rest = dig
    fine = (warm / 16384 - t1 / 1024) * t2 + (warm / 131072 - t1 / 8192) ** 2 * t3
    pressure = _pressure(fine, (p1, *rest), pressed, (32768.0, 524288.0))
    humidity = None
    if damp_dig:
        h1, h2, h3, h4, h5, h6 = damp_dig
        x = fine - 76800
        y = (damp - (h4 * 64 + h5 / 16384 * x)) * (
            h2 / 65536 * (1 + h6 / 67108864 * x * (1 + h3 / 67108864 * x))
        )
        humidity = _percent(y * (1 - h1 * y / 524288))
    return Measured(fine / 5120, humidity, None if pressure is None else pressure / 100)


def bme680(
    t: tuple[int, ...], p: tuple[int, ...], h: tuple[int, ...], raw: tuple[int, int, int]
) -> Measured:
    """The measurement of a BME680 (BST-BME680-DS001, 3.3), by its calibration `t`, `p` and `h`; its
    gas sensor stays off."""
    warm, pressed, damp = raw
    fine = (warm / 16384 - t[0] / 1024) * t[1] + (warm / 131072 - t[0] / 8192) ** 2 * t[2] * 16
    celsius = fine / 5120
    p1, p2, p3, p4, p5, p6, p7, p8, p9, p10 = p
    pressure = _pressure(
        fine, (p1, p2, p3, p4, p5, p6, p7 * 128, p8, p9), pressed, (131072.0, 16384.0), p10
    )
    y = damp - (h[0] * 16 + h[2] / 2 * celsius)
    y *= h[1] / 262144 * (1 + h[3] / 16384 * celsius + h[4] / 1048576 * celsius * celsius)
    humidity = y + (h[5] / 16384 + h[6] / 2097152 * celsius) * y * y
    return Measured(celsius, _percent(humidity), None if pressure is None else pressure / 100)


def _pressure(
    fine: float, p: Iterable[int], raw: int, divisors: tuple[float, float], p10: int = 0
) -> float | None:
    """The pressure, Pa, by the fine temperature. The divisors of P6 and P3 differ by chip. None for
    a calibration that gives none."""
    p1, p2, p3, p4, p5, p6, p7, p8, p9 = p
    x = fine / 2 - 64000
    y = (x * x * p6 / divisors[0] + x * p5 * 2) / 4 + p4 * 65536
    x = (p3 * x * x / divisors[1] + p2 * x) / 524288
    x = (1 + x / 32768) * p1
    if x == 0:
        return None
    pascal = (1048576 - raw - y / 4096) * 6250 / x
    further = (pascal / 256) ** 3 * p10 / 131072
    return pascal + (p9 * pascal * pascal / 2147483648 + pascal * p8 / 32768 + further + p7) / 16


def _percent(value: float) -> float:
    return min(max(value, 0.0), 100.0)
