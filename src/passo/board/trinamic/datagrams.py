"""Datagrams to and from a driver, over the one-wire UART and over SPI.

The layouts are those of the data sheets (TMC2209, chapter 4; TMC5160, chapter 4).
"""

from __future__ import annotations

ANSWER_BYTES = 10  # length of the answer to a read access, with start and stop bits
SPI_BYTES = 5

_SYNC = 0xF5  # the upper nibble is reserved; high bits end the sync nibble with an edge
_HOST = 0xFF  # the address in an answer
_WRITE = 0x80


def crc8(data: bytes) -> int:
    """The checksum of a UART datagram: x⁸ + x² + x + 1, each byte's lowest bit first."""
    crc = 0
    for byte in data:
        for bit in range(8):
            one = (crc >> 7 ^ byte >> bit) & 1
            crc = (crc << 1 & 0xFF) ^ (0x07 if one else 0)
    return crc


def uart_read(address: int, register: int) -> bytes:
    """A read access as the bit string that `tmcuart_send` takes."""
    return _line_bits(_sealed(bytes([_SYNC, address, register])))


def uart_write(address: int, register: int, value: int) -> bytes:
    """A write access as the bit string that `tmcuart_send` takes. The driver does not answer it."""
    head = bytes([_SYNC, address, register | _WRITE])
    return _line_bits(_sealed(head + value.to_bytes(4, "big")))


def uart_value(register: int, bits: bytes) -> int | None:
    """The value of `register` in the bits of an answer; None if the answer is damaged or names
    another register."""
    data = _from_line(bits)
    if data is None or len(data) != 8 or crc8(data[:7]) != data[7]:
        return None
    if data[0] & 0x0F != _SYNC & 0x0F or data[1] != _HOST or data[2] != register:
        return None
    return int.from_bytes(data[3:7], "big")


def spi_read(register: int) -> bytes:
    """A read access; the value comes back during the next access, of any kind."""
    return bytes([register, 0, 0, 0, 0])


def spi_write(register: int, value: int) -> bytes:
    """A write access; the value comes back during the next access."""
    return bytes([register | _WRITE]) + value.to_bytes(4, "big")


def spi_value(data: bytes) -> int | None:
    """The value in the received bytes; None if all bits are high, because no chip drove the
    line."""
    if len(data) != SPI_BYTES or data == b"\xff" * SPI_BYTES:
        return None
    return int.from_bytes(data[1:], "big")


def spi20(register: int, value: int) -> bytes:
    """An access to a TMC2660: a datagram of 20 bits, twice. The chip takes the second one."""
    datagram = register << 17 | value
    return (datagram << 20 | datagram).to_bytes(SPI_BYTES, "big")


def spi20_value(sent: bytes, data: bytes) -> int | None:
    """The answer of 20 bits to this access; None if the chip has not returned what was sent, or if
    one of the two bits that are always 0 is not."""
    if len(data) != SPI_BYTES:
        return None
    both = int.from_bytes(data, "big")
    returned = int.from_bytes(sent, "big") & 0xFFFFF
    right = both & 0xFFFFF == returned and both >> 28 & 3 == 0
    return both >> 20 if right else None


def _sealed(data: bytes) -> bytes:
    return data + bytes([crc8(data)])


def _line_bits(data: bytes) -> bytes:
    """Adds a start and a stop bit to each byte, and puts the first bit of the line into the lowest
    bit."""
    line = 0
    for i, byte in enumerate(data):
        line |= (byte << 1 | 0x200) << 10 * i
    return line.to_bytes((10 * len(data) + 7) // 8, "little")


def _from_line(bits: bytes) -> bytes | None:
    """Removes the start and stop bits; None if one of them is wrong."""
    line, size = int.from_bytes(bits, "little"), len(bits) * 8 // 10
    words = [line >> 10 * i & 0x3FF for i in range(size)]
    if any(word & 0x201 != 0x200 for word in words):
        return None
    return bytes(word >> 1 & 0xFF for word in words)
