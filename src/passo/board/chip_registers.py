"""The registers of a chip on a bus of a board. Calls that ask the board let time
pass and raise MachineError."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from passo.board.connection import Connection
    from passo.board.description import I2cPins, SpiPins

_READ = 0x80


class NotAcknowledgedError(Exception):
    """The device does not acknowledge a byte on I2C; the message is the status of the bus."""


class SpiRegisters:
    """The registers of a chip on SPI, each of one byte; the upper bit of an address means that it
    is read."""

    def __init__(self, connection: Connection, wire: SpiPins) -> None:
        self._connection = connection
        self._oid = connection.oids.spi_devices[wire]

    def read(self, address: int) -> int:
        """Asks for a register."""
        question = f"spi_transfer oid={self._oid} data={address | _READ:02x}00"
        return _bytes(self._connection.ask(question, "spi_transfer_response"))[1]

    def send(self, address: int, value: int) -> None:
        """Writes a register, and does not wait for the board."""
        self._connection.command(f"spi_send oid={self._oid} data={address:02x}{value:02x}")


class I2cRegisters:
    """The registers of a chip on I2C, each of `size` bytes. Klipper's firmware before August 2025
    has other commands; it shuts down where newer firmware reports a status."""

    def __init__(self, connection: Connection, wire: I2cPins, size: int = 1) -> None:
        self._connection, self._size = connection, size
        self._oid = connection.oids.i2c_devices[wire]
        self._reports_status = not connection.dictionary.takes("i2c_read", "reg")

    def read(self, address: int) -> int:
        """Asks for a register. Raises NotAcknowledgedError."""
        if self._reports_status:
            found = self._transfer(f"write={address:02x} read_len={self._size}")
        else:
            question = f"i2c_read oid={self._oid} reg={address:02x} read_len={self._size}"
            found = _bytes(self._connection.ask(question, "i2c_read_response"))
        return int.from_bytes(found, "big")

    def send(self, address: int, value: int) -> None:
        """Writes a register. Raises NotAcknowledgedError."""
        data = f"{address:02x}{value:0{2 * self._size}x}"
        if self._reports_status:
            self._transfer(f"write={data} read_len=0")
        else:
            self._connection.command(f"i2c_write oid={self._oid} data={data}")

    def _transfer(self, what: str) -> bytes:
        found = self._connection.ask(f"i2c_transfer oid={self._oid} {what}", "i2c_response")
        number = found["i2c_bus_status"]
        assert isinstance(number, int)
        status = self._connection.dictionary.name_of("i2c_bus_status", number)
        if status != "SUCCESS":
            raise NotAcknowledgedError(status)
        return _bytes(found)


def _bytes(found: Mapping[str, int | bytes]) -> bytes:
    response = found["response"]
    assert isinstance(response, bytes)
    return response
