"""What reading a chip consists of. A function for a chip is a generator: it yields transfers and
pauses, receives the bytes of each transfer, and yields each measurement."""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import dataclass
from typing import Literal, TypeAlias

ChipFault = Literal["silent", "garbled", "other-chip"]


@dataclass(frozen=True, slots=True)
class Transfer:
    """Writes bytes, then reads `count` bytes."""

    write: bytes = b""
    count: int = 0


@dataclass(frozen=True, slots=True)
class Measured:
    """A measurement: °C, % of relative humidity, hPa; None for what the chip does not measure."""

    celsius: float
    humidity: float | None = None
    pressure_hpa: float | None = None


class ChipError(Exception):
    """A chip does not answer as expected."""

    def __init__(self, fault: ChipFault, found: str) -> None:
        super().__init__(fault, found)
        self.fault: ChipFault = fault
        self._found = found

    def __str__(self) -> str:
        """What was found instead."""
        return self._found


Steps: TypeAlias = Generator[Transfer | float | Measured, bytes, None]
"""Transfers, pauses in seconds, and measurements. It does not end."""
