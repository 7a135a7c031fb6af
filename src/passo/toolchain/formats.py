"""The image formats of flash programs: a plain copy of the flash, Intel hex, UF2."""

from __future__ import annotations

import struct
from collections.abc import Iterator

_ROW = 16
_UF2_HEAD = (0x0A324655, 0x9E5D5157)
_UF2_END = 0x0AB16F30
_UF2_FAMILY_GIVEN = 0x2000
_UF2_PAYLOAD = 256
_RP2040 = 0xE48BFF56
_BOOT_SIZE = 256


def intel_hex(data: bytes, start: int) -> bytes:
    """Intel hex of `data`, whose first byte belongs at the address `start`."""
    return "".join(f"{line}\n" for line in _records(data, start)).encode()


def _records(data: bytes, start: int) -> Iterator[str]:
    high = 0
    for at in range(0, len(data), _ROW):
        address = start + at
        if address >> 16 != high:
            high = address >> 16
            yield _record(0, 4, high.to_bytes(2, "big"))
        yield _record(address & 0xFFFF, 0, data[at : at + _ROW])
    yield _record(0, 1, b"")


def _record(address: int, kind: int, content: bytes) -> str:
    body = bytes([len(content), *address.to_bytes(2, "big"), kind]) + content
    return f":{body.hex()}{-sum(body) & 0xFF:02x}".upper()


def uf2(data: bytes, start: int) -> bytes:
    """UF2 for an RP2040: blocks of 512 bytes, each with 256 of the flash and their address."""
    count = -(-len(data) // _UF2_PAYLOAD)
    blocks: list[bytes] = []
    for i in range(count):
        content = data[i * _UF2_PAYLOAD : (i + 1) * _UF2_PAYLOAD].ljust(_UF2_PAYLOAD, b"\0")
        address = start + i * _UF2_PAYLOAD
        head = (*_UF2_HEAD, _UF2_FAMILY_GIVEN, address, _UF2_PAYLOAD, i, count, _RP2040)
        blocks.append(struct.pack("<8I476sI", *head, content, _UF2_END))
    return b"".join(blocks)


def with_boot_sum(data: bytes) -> bytes:
    """A copy of an RP2040's flash whose first 256 bytes, the second stage of the loader, end in the
    checksum of the chip's ROM: CRC-32 with the polynomial 04C11DB7, from FFFFFFFF on, most
    significant bit first (data sheet, 2.8.1.3.1)."""
    crc = 0xFFFFFFFF
    for byte in data[: _BOOT_SIZE - 4]:
        crc ^= byte << 24
        for _ in range(8):
            crc = (crc << 1 ^ (0x04C11DB7 if crc >> 31 else 0)) & 0xFFFFFFFF
    return data[: _BOOT_SIZE - 4] + struct.pack("<I", crc) + data[_BOOT_SIZE:]
