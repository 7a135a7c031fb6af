"""What a compiler makes of the firmware."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any


@dataclass(frozen=True, slots=True)
class Image:
    """A finished build: as ELF, and as `file` for the flashing tool. Sizes in bytes; `ram` is
    static data without the stack. `dictionary` is what the board will tell of itself."""

    elf: Path
    file: Path
    flash: int
    ram: int
    dictionary: dict[str, Any]
