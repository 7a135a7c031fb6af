"""Stores the variables of SAVE_VARIABLE in a file."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from passo.errors import CommandError
from passo.job.durable_files import load_json, store_json


class SavedVariables:
    """The file of one printer; None stores nothing. A damaged file stays unchanged, and nothing is
    stored until the user repairs or removes it."""

    def __init__(self, path: Path | None) -> None:
        self._path = path
        self._refused: CommandError | None = None

    def load(self) -> dict[str, Any]:
        """The stored variables; empty without a file. Raises CommandError for a damaged one."""
        if self._path is None:
            return {}
        try:
            return load_json(self._path) or {}
        except (OSError, ValueError):
            self._refused = CommandError.of("macro.saved-unreadable", str(self._path))
            raise self._refused from None

    def save(self, variables: Mapping[str, Any]) -> None:
        """Stores all variables. When this returns, they survive a power cut. Raises CommandError;
        then the file is unchanged."""
        if self._path is None:
            raise CommandError.of("settings.nowhere")
        if self._refused is not None:
            raise self._refused
        try:
            store_json(self._path, variables)
        except OSError as error:
            reason = str(error.strerror)
            raise CommandError.of("macro.saved-unwritable", str(self._path), value=reason) from None
