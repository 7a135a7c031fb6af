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

from passo.board.trinamic.datagrams import (
    ANSWER_BYTES,
    spi20,
    spi20_value,
    spi_read,
    spi_value,
    spi_write,
    uart_read,
    uart_value,
    uart_write,
)
from passo.board.trinamic.settings import DriverSettings
from passo.board.trinamic.status import Reading, names_fault
from passo.config.trinamic import CHIPS, Chip, ChipName
from passo.errors import Problem

_TRIES = 5
_RESET, _DRV_ERR = 1, 2  # of GSTAT
_IFCNT, _IHOLD_IRUN = 0x02, 0x10
_DRVCONF, _READRSP, _RDSEL_LOW = 0x07, 0x10, 4  # of a TMC2660


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
        before = yield from self.read(_IFCNT)
        if before is None:
            return False
        for register, value in writes:
            with suppress(AnswerLostError):  # a write has no answer
                yield self._question(uart_write(self.address, register, value), 0)
        after = yield from self.read(_IFCNT)
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
                data = yield self._question(spi_read(_IHOLD_IRUN))
                return spi_value(data)

    def write(self, writes: list[tuple[int, int]]) -> Exchange[bool]:
        """Writes registers; True if the chip has returned all of them. Each access returns the data
        of the access before it."""
        accesses = [*(spi_write(*write) for write in writes), spi_read(_IHOLD_IRUN)]
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


@dataclass(slots=True)
class Spi20Wire:
    """Access over SPI to a TMC2660: the object `oid` of the board. Each access sends the same
    datagram of 20 bits twice, and the chip returns an answer and the first datagram: this verifies
    what is written. `select` is DRVCONF without RDSEL."""

    checked: ClassVar[bool] = False
    oid: int
    select: int = 0

    def read(self, register: int) -> Exchange[int | None]:
        """Reads one of the three answers; DRVCONF selects it."""
        datagram = spi20(_DRVCONF, self.select | (register - _READRSP) << _RDSEL_LOW)
        value: int | None = None
        for _ in range(2):  # the answer to the first access is the one that was selected before
            value = yield from self._access(datagram)
            if value is None:
                return None
        return value

    def write(self, writes: list[tuple[int, int]]) -> Exchange[bool]:
        """Writes registers; True if the chip has returned all of them."""
        right = True
        for register, value in writes:
            if register == _DRVCONF:
                self.select = value & ~(3 << _RDSEL_LOW)
            right &= (yield from self._access(spi20(register, value))) is not None
        return right

    def _access(self, datagram: bytes) -> Exchange[int | None]:
        while True:
            with suppress(AnswerLostError):
                data = yield f"spi_transfer oid={self.oid} data={datagram.hex()}"
                return spi20_value(datagram, data)


@dataclass(frozen=True, slots=True)
class DriverLink:
    """The driver of a motor, reached over `wire`; `place` names its pins in messages. All methods
    raise DriverFailure."""

    motor: str
    name: ChipName
    wire: _Wire
    place: str

    @property
    def chip(self) -> Chip:
        """The table of the chip."""
        return CHIPS[self.name]

    def configure(self, settings: DriverSettings) -> Exchange[None]:
        """Verifies that the chip is the right one, writes all its registers, and reads back those
        that are readable."""
        yield from self._identify()
        yield from self._write(settings.writes())
        yield from self._general()  # reading clears the flags of a TMC2130

    def change(self, before: DriverSettings, settings: DriverSettings) -> Exchange[None]:
        """Writes the registers whose values differ from those of the settings `before`."""
        old, new = dict(before.writes()), settings.writes()
        changed = [(register, value) for register, value in new if old.get(register) != value]
        if changed:
            yield from self._write(changed)

    def read(self, register: str) -> Exchange[int]:
        """Reads a register by its name."""
        return (yield from self._read(self.chip.registers[register].address))

    def status(self) -> Exchange[Reading]:
        """Reads the flags of the driver and of the chip; reads a fault twice unless a checksum
        protects the answer. A fault that appears between the two registers has its name too."""
        gstat = yield from self._general()
        status = yield from self.read(self.chip.status.name)
        if not self.wire.checked:  # a fault must be read twice before it is reported
            gstat &= yield from self._general()
            status &= yield from self.read(self.chip.status.name)
        if gstat & _DRV_ERR and not names_fault(self.name, status):
            again = yield from self.read(self.chip.status.name)
            if not self.wire.checked:
                again &= yield from self.read(self.chip.status.name)
            status |= again
        if gstat == status == 0:
            yield from self._identify()  # a line that is stuck low reads as no fault
        if not self.wire.checked and (yield from self._is_off()):
            gstat |= _RESET
        fields: dict[str, int] = {}
        for register in self.chip.measured:
            value = yield from self.read(register)
            fields |= self.chip.registers[register].unpack(value)
        return Reading(gstat, status, fields)

    def _write(self, writes: list[tuple[int, int]]) -> Exchange[None]:
        for _ in range(_TRIES):
            if (yield from self.wire.write(writes)):
                break
        else:
            raise self._failure("deaf")
        shown = {self.chip.registers[name].address for name in self.chip.shown}
        for register, value in writes:
            if register in shown and (yield from self._read(register)) != value:
                raise self._failure("deaf")

    def _general(self) -> Exchange[int]:
        """Reads GSTAT, if the chip has it."""
        return (yield from self.read("GSTAT")) if "GSTAT" in self.chip.registers else 0

    def _is_off(self) -> Exchange[bool]:
        """Whether the chip on SPI was reset and so is off; a TMC2130 reports a reset only once. A
        TMC2660 never reports one."""
        if "r" not in self.chip.registers["CHOPCONF"].access:
            return False
        toff = self.chip.registers["CHOPCONF"].fields["toff"]
        for _ in range(2):
            if toff.of((yield from self.read("CHOPCONF"))) != 0:
                return False
        return True

    def _identify(self) -> Exchange[None]:
        """Verifies the version; a TMC2660 has none, but it returns what it receives."""
        if self.chip.version is None:
            yield from self.read(self.chip.status.name)
            return
        version, found = self.chip.registers["IOIN"].fields["version"], 0
        for _ in range(_TRIES):
            found = version.of((yield from self.read("IOIN")))
            if found == self.chip.version:
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
        values = {"axis": self.motor, "value": value or self.name, "limit": self.place}
        return DriverFailure(Problem(f"driver.{code}", values=values))
