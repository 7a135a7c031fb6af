"""Images on disk: a file for the flash program and, beside it, a JSON file that describes it."""

from __future__ import annotations

import hashlib
import json
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from passo.config.board import Board
from passo.config.chips import Chip
from passo.errors import FirmwareError, Problem
from passo.toolchain.carried import Carried, carried_by, unlike
from passo.toolchain.contents import Parts, declares_end, hole, missing, outside, parts_of, starts
from passo.toolchain.targets import KLIPPERS, no_firmware


@dataclass(frozen=True, slots=True)
class About:
    """The content of the JSON file beside an image. Sizes in bytes; `ram_bytes` is static data,
    without the stack. The hashes are SHA-256 of the image file and of the compressed dictionary,
    which can be compared with the answer to `identify`."""

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
    """The description of an image; None if no JSON file of a build is beside it."""
    try:
        return About(**json.loads(about_path(image).read_text(encoding="utf-8")))
    except (OSError, ValueError, TypeError):
        return None


@dataclass(frozen=True, slots=True)
class Checked:
    """An image that may be flashed: its dictionary, if it has one, and a list of checks that were
    not possible."""

    carried: Carried | None
    unknown: tuple[str, ...]


def check_image(image: Path, name: str, board: Board, suffixes: tuple[str, ...]) -> Checked:
    """Checks that a file can be an image for the board `name`: its ending, content, addresses,
    declared length and dictionary. If a JSON file belongs to it, its board and its hash are checked
    too.

    Raises FirmwareError with the first error.
    """
    if image.suffix not in suffixes:
        raise _wrong(image, name, f"a file that ends in {' or '.join(suffixes)}")
    try:
        data = image.read_bytes()
    except OSError as error:
        raise _wrong(image, name, f"a file to read ({error.strerror})") from None
    about = read_about(image)
    if about is not None:
        if about.board != board.name:
            raise _wrong(image, name, f"one for {board.name}: this is for {about.board}")
        if about.sha256 != hashlib.sha256(data).hexdigest():
            raise _wrong(image, name, f"the image of {about_path(image).name}: its hash differs")
    if board.chip is None:
        raise no_firmware(name, KLIPPERS)
    try:
        parts = parts_of(data, image.suffix, board.chip.flash_start)
    except ValueError:
        raise _wrong(image, name, f"the content of a {image.suffix} file") from None
    _check_content(image, name, parts, board.chip)
    carried = carried_by(parts)
    other = unlike(carried.dictionary, board) if carried else None
    if other is not None:
        raise _wrong(image, name, f"one for {other[0]}: this is for {other[1]}")
    unknown: list[str] = []
    if about is None and carried is None:
        unknown.append("is for this board")
    # A plain copy of a flash may be truncated.
    if about is None and image.suffix == ".bin" and not declares_end(parts, board.chip):
        unknown.append("is whole")
    return Checked(carried, tuple(unknown))


def _check_content(image: Path, name: str, parts: Parts, chip: Chip) -> None:
    beyond = outside(parts, chip)
    if beyond is not None:
        last = chip.flash_start + chip.flash_bytes - 1
        flash = f"the flash of {chip.name}, 0x{chip.flash_start:x} to 0x{last:x}"
        raise _wrong(image, name, f"one for {flash}: this has something at 0x{beyond:x}")
    if not starts(parts, chip):
        raise _wrong(image, name, f"one that {chip.name} can start: this does not begin like it")
    lost = missing(parts, chip)
    if lost is not None:
        raise _wrong(image, name, f"a whole one: this is cut short and lacks what is at 0x{lost:x}")
    # In a gap of Intel hex, the flash keeps its old bytes, or becomes 0xFF.
    left_out = hole(parts) if image.suffix == ".hex" else None
    if left_out is not None:
        raise _wrong(image, name, f"a whole one: this lacks what is at 0x{left_out:x}")


def _wrong(image: Path, name: str, expected: str) -> FirmwareError:
    values = {"value": str(image), "axis": name, "limit": expected}
    return FirmwareError([Problem("firmware.image", values=values)])
