"""What all simulated sensor chips have in common: their bytes on the bus, and their faults."""

from __future__ import annotations

from abc import ABC, abstractmethod

_OPEN_BUS = 0xFF


class SensorChip(ABC):
    """A chip that measures `celsius`, `humidity` in % and `pressure_hpa`; its answers may be
    `checked` by a checksum. If not `plugged`, it does not answer; if `garbled`, one bit of each of
    its answers is wrong. All clocks are ticks of its board."""

    checked = False

    def __init__(self, clock_hz: float) -> None:
        self._hz = clock_hz
        self.celsius, self.humidity, self.pressure_hpa = 25.0, 40.0, 1000.0
        self.plugged, self.garbled = True, False
        self._written, self._written_at = b"", 0
        self._answer = b""

    def begin(self, reads: bool, clock: int) -> bool:
        """The chip is addressed. Returns whether it acknowledges."""
        if self._written:
            self.command(self._written, self._written_at)
            self._written = b""
        if not self.plugged:
            return False
        if not reads:
            return True
        answer = self.answer(clock)
        if answer is None:
            return False
        self._answer = bytes((answer[0] ^ 0x10, *answer[1:])) if self.garbled else answer
        return True

    def take(self, byte: int, clock: int) -> bool:
        """The chip receives a byte. Returns whether it acknowledges."""
        self._written, self._written_at = self._written + bytes((byte,)), clock
        return True

    def give(self, _: int) -> int:
        """The next byte of the answer."""
        first, self._answer = self._answer[:1], self._answer[1:]
        return first[0] if first else _OPEN_BUS

    def after(self, clock: int, seconds: float) -> int:
        """The clock so much later."""
        return clock + round(seconds * self._hz)

    @abstractmethod
    def command(self, data: bytes, clock: int) -> None:
        """Takes the bytes of a complete write, whose last byte came at this clock."""

    @abstractmethod
    def answer(self, clock: int) -> bytes | None:
        """The bytes for a read at this clock; None if the chip does not acknowledge it."""
