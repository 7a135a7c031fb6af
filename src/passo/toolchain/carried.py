"""Finds the data dictionary within an image, which the board sends for `identify`."""

from __future__ import annotations

import zlib
from collections.abc import Iterator
from dataclasses import dataclass

from passo.board.dictionary import Dictionary, DictionaryError
from passo.config.board import Board
from passo.toolchain.contents import Parts

# header of zlib data at the highest level (RFC 1950), as from Passo and Klipper
_BEGINS = b"\x78\xda"
# limit after decompression, against hostile files: Passo's dictionaries have about 6000
_MAX_BYTES = 1 << 20


@dataclass(frozen=True, slots=True)
class Carried:
    """A dictionary, and its compressed bytes in the image, which `identify` returns."""

    dictionary: Dictionary
    compressed: bytes


def carried_by(parts: Parts) -> Carried | None:
    """The first dictionary in an image's parts; None if there is none."""
    for content in _joined(parts):
        at = content.find(_BEGINS)
        while at >= 0:
            found = _unpacked(memoryview(content)[at:])
            if found is not None:
                return found
            at = content.find(_BEGINS, at + 1)
    return None


def _joined(parts: Parts) -> Iterator[bytes]:
    """The parts, with adjacent ones joined."""
    run, end = bytearray(), None
    for address, content in sorted(parts):
        if address != end:
            yield bytes(run)
            run.clear()
        run += content
        end = address + len(content)
    yield bytes(run)


def _unpacked(content: memoryview) -> Carried | None:
    reader = zlib.decompressobj()
    try:
        reader.decompress(content, _MAX_BYTES)
        if not reader.eof:
            return None
        compressed = bytes(content[: len(content) - len(reader.unused_data)])
        return Carried(Dictionary.parse(compressed), compressed)
    except (zlib.error, DictionaryError):
        return None


def unlike(dictionary: Dictionary, board: Board) -> tuple[str, str] | None:
    """The differences between an image's dictionary and the board's file, as (file, image); None if
    they agree. Values that the dictionary lacks are not compared. The name of the chip in the
    dictionary may be longer than `board.mcu`. The clock frequency is compared only for AVR chips:
    there, both firmwares use the frequency of the crystal."""
    console, avr = board.console, board.chip is not None and board.chip.core == "avr"
    expected = {"MCU": board.mcu, "CLOCK_FREQ": board.clock_hz}
    if console is not None and console.pins:
        pins = ",".join(map(board.pin, console.pins))
        expected |= {"SERIAL_BAUD": console.baud, "RESERVE_PINS_serial": pins}
    told = expected | dict(dictionary.constants)
    if not str(told["MCU"]).startswith(board.mcu):
        return board.mcu, str(told["MCU"])
    texts = ["{CLOCK_FREQ} Hz"] * avr
    if "RESERVE_PINS_serial" in expected:
        texts.append("{SERIAL_BAUD} baud on {RESERVE_PINS_serial}")
    pairs = ((text.format(**expected), text.format(**told)) for text in texts)
    return next((pair for pair in pairs if pair[0] != pair[1]), None)
