"""Images on disk: a file for the flashing tool and, beside it, a JSON file that says what it is."""

from __future__ import annotations

import hashlib
import json
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from passo.errors import FirmwareError, Problem

_UF2_MAGIC = b"UF2\n"
_ELF_MAGIC = b"\x7fELF"


@dataclass(frozen=True, slots=True)
class About:
    """What the JSON file beside an image says. Sizes in bytes; `ram_bytes` is static data, without
    the stack. The hashes are SHA-256 of the image's file and of the dictionary as the board carries
    it: the latter is what `identify` can be compared with."""

    target: str
    board: str
    mcu: str
    image: str
    sha256: str
    flash_bytes: int
    flash_size: int
    ram_bytes: int
    ram_size: int
    version: str
    compiler: str
    dictionary_sha256: str
    dictionary: dict[str, Any]


def about_path(image: Path) -> Path:
    """The JSON file that belongs to an image."""
    return image.with_suffix(".json")


def write_about(about: About, image: Path) -> Path:
    """Writes the JSON file beside the image; returns its path."""
    path = about_path(image)
    path.write_text(json.dumps(asdict(about), indent=2) + "\n", encoding="utf-8")
    return path


def read_about(image: Path) -> About | None:
    """What is known of an image; None if no JSON file of a build stands beside it."""
    try:
        return About(**json.loads(about_path(image).read_text(encoding="utf-8")))
    except (OSError, ValueError, TypeError):
        return None


def check_image(image: Path, board: str, mcu: str, suffixes: tuple[str, ...]) -> About | None:
    """Whether a file can be an image for a board: its ending, its content, and, where a JSON file
    stands beside it, its microcontroller and its hash. Returns what that file says.

    Raises FirmwareError with the first thing that is wrong.
    """
    if image.suffix not in suffixes:
        raise _wrong(image, board, f"a file that ends in {' or '.join(suffixes)}")
    try:
        data = image.read_bytes()
    except OSError as error:
        raise _wrong(image, board, f"a file to read ({error.strerror})") from None
    if not _looks_right(data, image.suffix):
        raise _wrong(image, board, f"the content of a {image.suffix} file")
    about = read_about(image)
    if about is not None and about.mcu != mcu:
        raise _wrong(image, board, f"one for {mcu}: this is for {about.mcu} ({about.board})")
    if about is not None and about.sha256 != hashlib.sha256(data).hexdigest():
        raise _wrong(image, board, f"the image of {about_path(image).name}: its hash differs")
    return about


def _looks_right(data: bytes, suffix: str) -> bool:
    if suffix == ".hex":
        return _is_intel_hex(data)
    if suffix == ".uf2":
        return len(data) >= 512 and len(data) % 512 == 0 and data.startswith(_UF2_MAGIC)
    if suffix == ".elf":
        return data.startswith(_ELF_MAGIC)
    return len(data) > 0


def _is_intel_hex(data: bytes) -> bool:
    """Every record's sum is 0 modulo 256, and the last one ends the file."""
    rows = data.split()
    for row in rows:
        try:
            record = bytes.fromhex(row[1:].decode("ascii"))
        except ValueError:
            return False
        if row[:1] != b":" or len(record) < 5 or len(record) != record[0] + 5 or sum(record) % 256:
            return False
    return bool(rows) and rows[-1] == b":00000001FF"


def _wrong(image: Path, board: str, expected: str) -> FirmwareError:
    values = {"value": str(image), "axis": board, "limit": expected}
    return FirmwareError([Problem("firmware.image", values=values)])
