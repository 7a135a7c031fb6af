"""Simulated chips that give a temperature, and perhaps the humidity, for a command."""

from __future__ import annotations

from passo.simulator.sensor_chips.chip import SensorChip


def _crc8(data: bytes, start: int) -> int:
    """By polynomial division of the whole message: x⁸ + x⁵ + x⁴ + 1."""
    rest = int.from_bytes(bytes((data[0] ^ start, *data[1:], 0)), "big")
    for bit in range(8 * len(data) + 7, 7, -1):
        if rest >> bit & 1:
            rest ^= 0x131 << (bit - 8)
    return rest


def _word(share: float, full: int, mask: int = 0xFFFF) -> int:
    return min(max(round(share * full), 0), 65535) & mask


class Lm75(SensorChip):
    """An LM75: 9 bits of 0.5 °C in its register 0."""

    _register = 0

    def command(self, data: bytes, clock: int) -> None:
        """The first byte selects a register."""
        self._register = data[0]

    def answer(self, clock: int) -> bytes | None:
        """The temperature in the upper bits."""
        halves = round(self.celsius * 2) if self._register == 0 else 0
        return (halves << 7 & 0xFFFF).to_bytes(2, "big")


class HtuChip(SensorChip):
    """An HTU21D, SHT21, Si7013, Si7020 or Si7021, without holding the clock low. While it measures,
    it does not acknowledge a read."""

    checked = True
    _SECONDS = {0xF3: 0.085, 0xF5: 0.029, 0xFE: 0.015}

    def __init__(self, clock_hz: float, kind: str) -> None:
        super().__init__(clock_hz)
        self._off_per_c = 0.15 if kind == "htu21d" else 0.0
        self._command, self._ready = 0, 0

    def command(self, data: bytes, clock: int) -> None:
        """A measurement of the temperature or of the humidity, or a reset."""
        self._command = data[0]
        self._ready = self.after(clock, self._SECONDS.get(self._command, 0.0))

    def answer(self, clock: int) -> bytes | None:
        """A word with its status in the lower two bits, and a checksum."""
        if clock < self._ready or self._command not in (0xF3, 0xF5):
            return None
        if self._command == 0xF3:
            word = _word((self.celsius + 46.85) / 175.72, 65536, ~3)
        else:
            damp = self.humidity + (25 - self.celsius) * self._off_per_c
            word = _word((damp + 6) / 125, 65536, ~3) | 2
        data = word.to_bytes(2, "big")
        return data + bytes((_crc8(data, 0),))


class ShtChip(SensorChip):
    """An SHT30, SHT31 or SHT35, without clock stretching."""

    checked = True

    def __init__(self, clock_hz: float) -> None:
        super().__init__(clock_hz)
        self._ready: int | None = None

    def command(self, data: bytes, clock: int) -> None:
        """A measurement of high repeatability."""
        self._ready = self.after(clock, 0.0155) if data == b"\x24\x00" else None

    def answer(self, clock: int) -> bytes | None:
        """Two words with a checksum each."""
        if self._ready is None or clock < self._ready:
            return None
        found = b""
        for share in ((self.celsius + 45) / 175, self.humidity / 100):
            data = _word(share, 65535).to_bytes(2, "big")
            found += data + bytes((_crc8(data, 0xFF),))
        return found


class AhtChip(SensorChip):
    """An AHT10, or with a checksum an AHT20 or AHT30. Before its calibration is loaded, an AHT10 or
    AHT20 measures nothing."""

    def __init__(self, clock_hz: float, kind: str) -> None:
        super().__init__(clock_hz)
        self._load = {"aht1x": b"\xe1\x08\x00", "aht2x": b"\xbe\x08\x00"}.get(kind)
        self.checked = kind != "aht1x"
        self._loaded = self._load is None
        self._ready: int | None = None

    def command(self, data: bytes, clock: int) -> None:
        """The load of the calibration, or a measurement."""
        self._loaded |= data == self._load
        if data == b"\xac\x33\x00" and self._loaded:
            self._ready = self.after(clock, 0.08)

    def answer(self, clock: int) -> bytes | None:
        """The status, 20 bits of humidity, 20 bits of temperature."""
        busy = self._ready is None or clock < self._ready
        warm, damp = round((self.celsius + 50) / 200 * 2**20), round(self.humidity / 100 * 2**20)
        status = (0x80 if busy else 0) | (0x08 if self._loaded else 0)
        data = bytes((status,)) + (damp << 20 | warm).to_bytes(5, "big")
        return data + bytes((_crc8(data, 0xFF),)) if self.checked else data
