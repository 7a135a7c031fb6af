"""The exchanges with one driver: set-up, verification, status. They do not wait. An `Exchange` is a
generator: it yields a command for the board, and the caller sends it the bytes of the answer, or no
bytes if the driver did not answer. If the board received the command but its answer was lost, the
caller throws `AnswerLostError` into the generator.
"""

from __future__ import annotations

from collections.abc import Generator
from contextlib import suppress
from dataclasses import dataclass
from typing import Any, ClassVar, Protocol, TypeAlias, TypeVar

from passo.board.trinamic import registers as r
from passo.board.trinamic.datagrams import (
    ANSWER_BYTES,
    spi_read,
    spi_value,
    spi_write,
    uart_read,
    uart_value,
    uart_write,
)
from passo.board.trinamic.settings import DriverSettings
from passo.board.trinamic.status import Reading
from passo.config.trinamic import ChipName
from passo.errors import Problem

_TRIES = 5
_RESET = 1  # of GSTAT
_SHOWN = (r.GCONF, r.CHOPCONF)  # on every chip, these registers read back as they were written


T = TypeVar("T")
Exchange: TypeAlias = Generator[str, bytes, T]


class DriverFailure(Exception):
    """The driver does not answer, or is another chip."""

    def __init__(self, problem: Problem) -> None:
        super().__init__(str(problem))
        self.problem = problem

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickles the problem, because the text of the error does not contain it."""
        return DriverFailure, (self.problem,), self.__dict__


class AnswerLostError(Exception):
    """The board has executed the command, and its answer was lost."""


class _Wire(Protocol):
    """Access to the registers. On failure `read` returns None and `write` returns False. If
    `checked`, a checksum protects the answers."""

    checked: ClassVar[bool]

    def read(self, register: int) -> Exchange[int | None]:
        """The register's 32 bits; None if the chip does not answer."""
        ...

    def write(self, writes: list[tuple[int, int]]) -> Exchange[bool]:
        """Writes (register, value) in this order; returns whether the chip has accepted them
        all."""
        ...


@dataclass(frozen=True, slots=True)
class UartWire:
    """Access over a UART that several drivers may share: the object `oid` of the board."""

    checked: ClassVar[bool] = True
    oid: int
    address: int

    def read(self, register: int) -> Exchange[int | None]:
        """Reads a register; None if no valid answer arrives."""
        while True:
            with suppress(AnswerLostError):
                bits = yield self._question(uart_read(self.address, register), ANSWER_BYTES)
                return uart_value(register, bits)

    def write(self, writes: list[tuple[int, int]]) -> Exchange[bool]:
        """Writes registers; True if the driver's counter of writes shows that all have arrived."""
        before = yield from self.read(r.IFCNT)
        if before is None:
            return False
        for register, value in writes:
            with suppress(AnswerLostError):  # a write has no answer
                yield self._question(uart_write(self.address, register, value), 0)
        after = yield from self.read(r.IFCNT)
        return after is not None and after - before & 0xFF == len(writes)

    def _question(self, bits: bytes, read: int) -> str:
        return f"tmcuart_send oid={self.oid} write={bits.hex()} read={read}"


@dataclass(frozen=True, slots=True)
class SpiWire:
    """Access over SPI: the object `oid` of the board."""

    checked: ClassVar[bool] = False
    oid: int

    def read(self, register: int) -> Exchange[int | None]:
        """Reads a register with two accesses: the second one returns the value."""
        while True:
            with suppress(AnswerLostError):
                yield self._question(spi_read(register))
                data = yield self._question(spi_read(r.IHOLD_IRUN))
                return spi_value(data)

    def write(self, writes: list[tuple[int, int]]) -> Exchange[bool]:
        """Writes registers; True if the chip has returned all of them. Each access returns the data
        of the access before it."""
        accesses = [*(spi_write(*write) for write in writes), spi_read(r.GSTAT)]
        right = True
        i, written = 0, None
        while i < len(accesses):
            try:
                data = yield self._question(accesses[i])
            except AnswerLostError:
                # the lost answer belonged to the previous access, which the caller repeats
                i, written = max(i - 1, 0), None
                continue
            right &= written is None or spi_value(data) == written
            written = writes[i][1] if i < len(writes) else None
            i += 1
        return right

    def _question(self, data: bytes) -> str:
        return f"spi_transfer oid={self.oid} data={data.hex()}"


@dataclass(frozen=True, slots=True)
class DriverLink:
    """The driver of a motor, reached over `wire`; `place` names its pins in messages. All methods
    raise DriverFailure."""

    motor: str
    chip: ChipName
    wire: _Wire
    place: str

    def configure(self, settings: DriverSettings) -> Exchange[None]:
        """Verifies that the chip is the right one, writes all its registers, and reads back those
        that are readable."""
        yield from self._identify()
        writes = settings.writes()
        for _ in range(_TRIES):
            if (yield from self.wire.write(writes)):
                break
        else:
            raise self._failure("deaf")
        for register, value in writes:
            if register in _SHOWN and (yield from self._read(register)) != value:
                raise self._failure("deaf")
        yield from self._read(r.GSTAT)  # reading clears the flags of a TMC2130

    def status(self) -> Exchange[Reading]:
        """Reads GSTAT and DRV_STATUS; reads a fault twice unless a checksum protects the answer."""
        gstat = yield from self._read(r.GSTAT)
        status = yield from self._read(r.DRV_STATUS)
        if not self.wire.checked:  # a fault must be read twice before it is reported
            gstat &= yield from self._read(r.GSTAT)
            status &= yield from self._read(r.DRV_STATUS)
        if gstat == status == 0:
            yield from self._identify()  # a line that is stuck low reads as no fault
        if not self.wire.checked and (yield from self._is_off()):
            gstat |= _RESET
        return Reading(gstat, status)

    def _is_off(self) -> Exchange[bool]:
        """Whether the chip on SPI was reset and so is off; a TMC2130 reports a reset only once."""
        toff = r.CHIPS[self.chip].fields[r.CHOPCONF]["toff"]
        for _ in range(2):
            if toff.of((yield from self._read(r.CHOPCONF))) != 0:
                return False
        return True

    def _identify(self) -> Exchange[None]:
        chip, found = r.CHIPS[self.chip], 0
        for _ in range(_TRIES):
            found = chip.version_of((yield from self._read(chip.version_register)))
            if found == chip.version:
                return
        if found == 0:
            raise self._failure("silent")
        raise self._failure("other-chip", f"0x{found:02x}")

    def _read(self, register: int) -> Exchange[int]:
        for _ in range(_TRIES):
            value = yield from self.wire.read(register)
            if value is not None:
                return value
        raise self._failure("silent")

    def _failure(self, code: str, value: str = "") -> DriverFailure:
        values = {"axis": self.motor, "value": value or self.chip, "limit": self.place}
        return DriverFailure(Problem(f"driver.{code}", values=values))
