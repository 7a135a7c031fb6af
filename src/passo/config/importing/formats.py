"""Selects the importer of a configuration by its file name."""

from __future__ import annotations

from typing import TYPE_CHECKING

from passo.config.importing import aprinter, klipper, marlin, rrf
from passo.config.importing.settling import settle
from passo.errors import ConfigError

if TYPE_CHECKING:
    from pathlib import Path

    from passo.config.importing.draft import Draft

_HEADERS = (".h", ".hpp")


def imported(path: Path, stored: Path | None = None, *, board: str | None = None) -> Draft:
    """Converts a configuration to a valid machine file with remarks. The file name selects the
    format: Marlin (`.h`), APrinter (`.json`), RepRapFirmware (`.g`), otherwise Klipper
    (`printer.cfg`). `stored` is a file with the settings that the firmware has stored since.
    `board` is the name of a shipped board in place of the one in the file. Raises ConfigError."""
    ending = path.suffix.lower()
    if ending == ".json":
        draft = aprinter.imported(path, stored, board=board)
    elif ending in _HEADERS:
        draft = marlin.imported(path, stored, board=board)
    elif stored is not None:
        raise ConfigError.of("import.stored", str(stored))
    elif ending == ".g":
        draft = rrf.imported(path, board=board)
    else:
        draft = klipper.imported(path, board=board)
    settle(draft)
    return draft
