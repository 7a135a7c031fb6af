"""Stores the variables of SAVE_VARIABLE in a file."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from passo.errors import CommandError
from passo.job.durable_files import load_json, store_json
from passo.printer.saved_variables import SavedVariables


class VariableFile(SavedVariables):
    """The file of one printer; None stores nothing. A damaged file stays unchanged, and nothing is
    stored until the user repairs or removes it. `refused` has the error of a damaged file."""

    def __init__(self, path: Path | None) -> None:
        super().__init__()
        self._path = path
        self.refused: list[CommandError] = []
        try:
            self.values = {} if path is None else load_json(path) or {}
        except (OSError, ValueError):
            self.refused.append(CommandError.of("macro.saved-unreadable", str(path)))

    def save(self, values: dict[str, Any]) -> None:
        """Stores all variables. When this returns, they survive a power cut. Raises CommandError;
        then the file is unchanged."""
        if self._path is None:
            raise CommandError.of("settings.nowhere")
        if self.refused:
            raise self.refused[0]
        try:
            store_json(self._path, values)
        except OSError as error:
            reason = str(error.strerror)
            raise CommandError.of("macro.saved-unwritable", str(self._path), value=reason) from None
        super().save(values)
