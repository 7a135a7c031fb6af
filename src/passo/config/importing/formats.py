"""Selects the importer of a configuration by its file name."""

from __future__ import annotations

from typing import TYPE_CHECKING

from passo.config.importing import aprinter, klipper, marlin
from passo.errors import ConfigError

if TYPE_CHECKING:
    from pathlib import Path

    from passo.config.importing.draft import Draft

_HEADERS = (".h", ".hpp")


def imported(path: Path, stored: Path | None = None) -> Draft:
    """Converts a configuration to a machine file with remarks. The file name selects the format:
    Marlin (`.h`), APrinter (`.json`), otherwise Klipper (`printer.cfg`). `stored` is a file with
    the settings that the firmware has stored since. Raises ConfigError."""
    ending = path.suffix.lower()
    if ending == ".json":
        return aprinter.imported(path, stored)
    if ending in _HEADERS:
        return marlin.imported(path, stored)
    if stored is not None:
        raise ConfigError.of("import.stored", str(stored))
    return klipper.imported(path)
