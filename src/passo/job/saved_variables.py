"""The variables of SAVE_VARIABLE, in a file that is whole or refused."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any, cast

from passo.errors import CommandError
from passo.job.durable_files import replaced

_LARGEST = 8 << 20  # bytes


class SavedVariables:
    """The file of one printer; None keeps nothing. A damaged file is left as it is: nothing is
    stored until it is repaired or removed."""

    def __init__(self, path: Path | None) -> None:
        self._path = path
        self._refused: CommandError | None = None

    def load(self) -> dict[str, Any]:
        """What is stored; empty without a file. Raises CommandError for a damaged one."""
        if self._path is None or not self._path.exists():
            return {}
        try:
            with self._path.open("rb") as file:
                raw = file.read(_LARGEST + 1)
            found: object = json.loads(raw) if len(raw) <= _LARGEST else None
        except (OSError, ValueError, RecursionError):
            found = None
        if not isinstance(found, dict):
            self._refused = CommandError.of("macro.saved-unreadable", str(self._path))
            raise self._refused
        return cast("dict[str, Any]", found)

    def save(self, variables: Mapping[str, Any]) -> None:
        """Stores all variables; they survive a power cut when this returns. Raises CommandError,
        and the file is as before then."""
        if self._path is None:
            raise CommandError.of("settings.nowhere")
        if self._refused is not None:
            raise self._refused
        try:
            self._path.parent.mkdir(parents=True, exist_ok=True)
            with replaced(self._path) as temporary:
                temporary.write_text(json.dumps(dict(variables), indent=1, sort_keys=True))
        except OSError as error:
            reason = str(error.strerror)
            raise CommandError.of("macro.saved-unwritable", str(self._path), value=reason) from None
