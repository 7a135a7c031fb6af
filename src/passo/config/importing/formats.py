"""Which firmware a configuration is of."""

from __future__ import annotations

from typing import TYPE_CHECKING

from passo.config.importing import klipper, marlin

if TYPE_CHECKING:
    from pathlib import Path

    from passo.config.importing.draft import Draft

_HEADERS = (".h", ".hpp")


def imported(path: Path) -> Draft:
    """The machine file of a configuration, with remarks: Marlin's Configuration.h by its ending,
    else Klipper's printer.cfg. Raises ConfigError."""
    if path.suffix.lower() in _HEADERS:
        return marlin.imported(path)
    return klipper.imported(path)
