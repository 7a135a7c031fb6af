"""The lock of a state folder, which one printer at a time uses."""

from __future__ import annotations

import logging
import os
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

from passo.errors import InputError
from passo.job.durable_files import directory_held, load_json, store_json

_log = logging.getLogger(__name__)


class StateLock:
    """Locks a folder until it is released or the process ends. The file `serving` in it names the
    printer: its machine, its process, and its addresses. Raises InputError with that name if
    another process has the lock. A folder that cannot be locked is reported when it is used."""

    def __init__(self, folder: Path, machine: str) -> None:
        self._path, self._machine = folder / "serving", machine
        try:
            self._held = directory_held(folder)
        except BlockingIOError:
            raise InputError.of("state.busy", str(folder), value=_holder(self._path)) from None
        self.note(())

    def note(self, places: Sequence[str]) -> None:
        """Stores the addresses of the printer, for other programs and for the message of another
        printer with this folder."""
        if self._held is None:
            return
        serving = {"machine": self._machine, "process": os.getpid(), "places": list(places)}
        try:
            store_json(self._path, serving)
        except OSError as error:
            _log.warning("%s is not stored: %s", self._path, error.strerror or error)

    def release(self) -> None:
        """Releases the folder."""
        if self._held is not None:
            with suppress(OSError):
                self._path.unlink()
            os.close(self._held)
            self._held = None


def _holder(path: Path) -> str:
    """The printer that uses the folder, as it has stored it."""
    try:
        found = load_json(path) or {}
        name = f"{found['machine']}, process {found['process']}"
        return ", ".join([name, *map(str, found["places"])])
    except (OSError, ValueError, KeyError, TypeError):
        return "it has not stored its name"
