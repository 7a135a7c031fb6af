"""Motor drivers of Trinamic's, as their data sheets describe what a host sees of them."""

from __future__ import annotations

from tests.oracles.trinamic import answer, checksum

_GSTAT, _IFCNT = 0x01, 0x02
# Where the version stands, and it.
VERSIONS = {"TMC2208": (0x06, 0x20), "TMC2209": (0x06, 0x21), "TMC2130": (0x04, 0x11)}
# Registers that may be read; of the others nobody gets to know.
_READABLE = {
    "TMC2208": {0x00, 0x01, 0x02, 0x06, 0x6A, 0x6C, 0x6F, 0x70},
    "TMC2209": {0x00, 0x01, 0x02, 0x06, 0x6A, 0x6C, 0x6F, 0x70},
    "TMC2130": {0x00, 0x01, 0x04, 0x6A, 0x6C, 0x6F},
}


class Chip:
    """Its `registers`, and how many times they were `written`."""

    def __init__(self, name: str, address: int = 0) -> None:
        self.name = name
        self.address = address
        self.plugged = True
        self.written = 0
        self.registers: dict[int, int] = {}
        self._last = 0
        self.power_on()

    def power_on(self) -> None:
        where, version = VERSIONS[self.name]
        self.registers = {_GSTAT: 1, where: version << 24}

    def _read(self, register: int) -> int:
        value = self.registers.get(register, 0) if register in _READABLE[self.name] else 0
        if register == _GSTAT and self.name == "TMC2130":
            self.registers[_GSTAT] = 0
        return value

    def _write(self, register: int, value: int) -> None:
        self.written += 1
        if register != _GSTAT:
            self.registers[register] = value
        elif self.name != "TMC2130":  # ones are cleared
            self.registers[_GSTAT] &= ~value

    def datagram(self, data: bytes) -> bytes:
        """What it answers by UART, if anything."""
        meant = data[:2] == bytes([0xF5, self.address]) and checksum(data[:-1]) == data[-1]
        if not self.plugged or not meant:
            return b""
        register = data[2] & 0x7F
        if data[2] & 0x80 and len(data) == 8:
            self._write(register, int.from_bytes(data[3:7], "big"))
            self.registers[_IFCNT] = (self.registers.get(_IFCNT, 0) + 1) % 256
            return b""
        return answer(register, self._read(register))

    def transfer(self, data: bytes) -> bytes:
        """What comes back by SPI while this goes in: the answer to what came before."""
        if not self.plugged:
            return bytes(len(data))
        told = bytes([self.registers[_GSTAT] & 3]) + self._last.to_bytes(4, "big")
        register = data[0] & 0x7F
        if data[0] & 0x80:
            self._last = int.from_bytes(data[1:], "big")
            self._write(register, self._last)
        else:
            self._last = self._read(register)
        return told
