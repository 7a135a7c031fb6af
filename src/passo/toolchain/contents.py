"""Reads the bytes of an image file, and checks whether a chip could start with them."""

from __future__ import annotations

import struct
from collections.abc import Iterator
from typing import TypeAlias

from passo.config.chips import Chip
from passo.toolchain import arm, avr

# Parts of the flash: the address of the first byte, and at least one byte.
Parts: TypeAlias = list[tuple[int, bytes]]

_UF2_BLOCK = 512
_UF2_MAX = 476  # maximum content of a block in bytes
_UF2_MAGIC = (0x0A324655, 0x9E5D5157, 0x0AB16F30)
_UF2_NOT_FLASH = 1
_ALIGNMENT = 8
_OWN_MARK = 0x6F737350  # OWN_MARK in firmware/hal/arm/start.c


def parts_of(data: bytes, suffix: str, flash_start: int) -> Parts:
    """The parts of a file with this ending. A plain copy (`.bin`) starts at `flash_start`. Raises
    ValueError if its content does not match the ending."""
    try:
        match suffix:
            case ".hex":
                found = list(_of_hex(data))
            case ".uf2":
                found = list(_of_uf2(data))
            case ".elf":
                found = [(part.load, part.content) for part in arm.segments(data)]
            case _:
                found = [(flash_start, data)]
    except (struct.error, avr.FirmwareError) as error:
        raise ValueError(str(error)) from None
    found = [(address, content) for address, content in found if content]
    if not found:
        raise ValueError("nothing would be written")
    return found


def _of_hex(data: bytes) -> Iterator[tuple[int, bytes]]:
    """Intel hex: the sum of every record is 0 modulo 256, and the last one ends the file."""
    base, kind = 0, 0
    for row in data.split():
        record = bytes.fromhex(row[1:].decode("ascii"))
        if row[:1] != b":" or len(record) < 5 or len(record) != record[0] + 5 or sum(record) % 256:
            raise ValueError("a damaged record")
        if kind == 1:
            raise ValueError("a record after the last one")
        at, kind, content = int.from_bytes(record[1:3]), record[3], record[4:-1]
        if kind == 0:
            yield base + at, content
        elif kind in (2, 4):
            base = int.from_bytes(content) << (4 if kind == 2 else 16)
    if kind != 1:
        raise ValueError("no last record")


def _of_uf2(data: bytes) -> Iterator[tuple[int, bytes]]:
    for at in range(0, len(data), _UF2_BLOCK):
        first, second, flags, address, count, _, blocks = struct.unpack_from("<7I", data, at)
        (end,) = struct.unpack_from("<I", data, at + _UF2_BLOCK - 4)
        if (first, second, end) != _UF2_MAGIC or count > _UF2_MAX:
            raise ValueError("a damaged block")
        if blocks * _UF2_BLOCK > len(data):
            raise ValueError("blocks are missing")
        if not flags & _UF2_NOT_FLASH:
            yield address, data[at + 32 : at + 32 + count]


def outside(parts: Parts, chip: Chip) -> int | None:
    """The first address in the parts that is not in the chip's flash; None if there is none."""
    end = chip.flash_start + chip.flash_bytes
    for address, content in sorted(parts):
        if address < chip.flash_start:
            return address
        if address + len(content) > end:
            return max(address, end)
    return None


def missing(parts: Parts, chip: Chip) -> int | None:
    """The address of a part of the image that is missing in the file; None if none is known to be
    missing. It checks the start vector of a Cortex-M core, and the end that Passo's images
    declare."""
    if chip.core == "avr" or chip.key in arm.STAGED:
        return None
    end = max(address + len(content) for address, content in parts)
    words = struct.unpack("<9I", _head(parts, chip, 36))
    needed = [words[1] & ~1, *([words[7] - 1] if words[8] == _OWN_MARK else [])]
    return next((address for address in needed if address >= end), None)


def hole(parts: Parts) -> int | None:
    """The first address of a gap between the parts; None if there is none. Padding that a linker
    adds to align the next part does not count: it is never read."""
    ordered = sorted((address, address + len(content)) for address, content in parts)
    end = ordered[0][1]
    for first, behind in ordered:
        if first - end >= _ALIGNMENT:
            return end
        end = max(end, behind)
    return None


def declares_end(parts: Parts, chip: Chip) -> bool:
    """Whether the image of a Cortex-M declares its end, as Passo's images do."""
    return struct.unpack("<9I", _head(parts, chip, 36))[8] == _OWN_MARK


def _head(parts: Parts, chip: Chip, count: int) -> bytes:
    """The first bytes of the flash; a byte outside of the parts is 0xFF."""
    first = {
        address - chip.flash_start + i: byte
        for address, content in parts
        if address < chip.flash_start + count
        for i, byte in enumerate(content[:count])
    }
    return bytes(first.get(i, 0xFF) for i in range(count))


def starts(parts: Parts, chip: Chip) -> bool:
    """Whether the flash would begin with the start vector of the chip's core: a jump on AVR chips;
    on Cortex-M the end of a stack in RAM, and the odd address of code in flash. True for a chip
    whose ROM checks a boot stage, because the ROM decides there."""
    if chip.key in arm.STAGED:
        return True
    head = _head(parts, chip, 8)
    if chip.core == "avr":
        (word,) = struct.unpack_from("<H", head)
        return word & 0xFE0E == 0x940C or word & 0xF000 == 0xC000  # jmp, rjmp
    stack, code = struct.unpack("<2I", head)
    in_ram = chip.ram_start < stack <= chip.ram_start + chip.ram_bytes
    in_flash = chip.flash_start <= code < chip.flash_start + chip.flash_bytes
    return in_ram and in_flash and code % 2 == 1
