"""The compiled firmware."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any


@dataclass(frozen=True, slots=True)
class Image:
    """A finished build: as ELF, and as `file` for the flash program. Sizes in bytes; `ram` is
    static data without the stack. `dictionary` is the one that the board will report."""

    elf: Path
    file: Path
    flash: int
    ram: int
    dictionary: dict[str, Any]
