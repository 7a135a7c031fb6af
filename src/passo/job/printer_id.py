"""The id of a printer: a UUID that is made at its first start."""

from __future__ import annotations

import logging
from pathlib import Path
from uuid import UUID, uuid4

from passo.job.durable_files import replaced

_log = logging.getLogger(__name__)


def printer_id(folder: Path | None) -> str:
    """The id of the printer whose state is in `folder`; it is made and stored if there is none.
    Without a folder, and if it cannot be stored, it lasts until the program ends."""
    if folder is None:
        return str(uuid4())
    path = folder / "printer-id"
    try:
        return str(UUID(path.read_text("ascii").strip()))
    except FileNotFoundError:
        pass
    except (OSError, ValueError) as error:
        _log.warning("%s cannot be read, so this printer gets a new id: %s", path, error)
    made = str(uuid4())
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with replaced(path) as temporary:
            temporary.write_text(f"{made}\n", "ascii")
    except OSError as error:
        why = error.strerror or error
        _log.warning("The id of this printer lasts until Passo ends: %s: %s", path, why)
    return made
