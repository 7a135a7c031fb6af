"""Datagrams of Trinamic's one-wire UART, bit by bit as the data sheets draw them."""

from __future__ import annotations

from collections.abc import Sequence


def checksum(data: bytes) -> int:
    """x⁸ + x² + x + 1 over the bits as they come, by long division of polynomials."""
    bits = "".join(f"{byte:08b}"[::-1] for byte in data) + "0" * 8
    value = int(bits, 2)
    for i in range(len(bits) - 1, 7, -1):
        if value >> i & 1:
            value ^= 0b100000111 << (i - 8)
    return value


def read_request(address: int, register: int) -> bytes:
    body = bytes([0xF5, address, register])
    return body + bytes([checksum(body)])


def write_access(address: int, register: int, value: int) -> bytes:
    body = bytes([0xF5, address, register | 0x80]) + value.to_bytes(4, "big")
    return body + bytes([checksum(body)])


def answer(register: int, value: int) -> bytes:
    body = bytes([0x05, 0xFF, register]) + value.to_bytes(4, "big")
    return body + bytes([checksum(body)])


def line_bits(data: bytes) -> list[int]:
    """Start bit, data from the lowest bit, stop bit."""
    bits: list[int] = []
    for byte in data:
        bits += [0, *(byte >> i & 1 for i in range(8)), 1]
    return bits


def line_bytes(bits: bytes) -> bytes:
    """The bytes between start and stop bits, which must be there; eight bits a byte, the first one
    lowest, and the line is high behind the last."""
    line = [byte >> i & 1 for byte in bits for i in range(8)]
    found: list[int] = []
    for at in range(0, len(line) - 9, 10):
        start, *byte, stop = line[at : at + 10]
        assert (start, stop) == (0, 1)
        found.append(sum(bit << i for i, bit in enumerate(byte)))
    return bytes(found)


def packed(bits: Sequence[int]) -> bytes:
    """Eight bits a byte, the first one lowest."""
    return bytes(
        sum(bit << i for i, bit in enumerate(bits[at : at + 8])) for at in range(0, len(bits), 8)
    )
