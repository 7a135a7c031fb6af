"""The variables of SAVE_VARIABLE."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any


class SavedVariables:
    """The variables of SAVE_VARIABLE by name. This class keeps them in memory."""

    def __init__(self, values: Mapping[str, Any] | None = None) -> None:
        self.values: dict[str, Any] = dict(values or {})

    def save(self, values: dict[str, Any]) -> None:
        """Replaces all variables. Raises CommandError if they cannot be stored; then none
        changes."""
        self.values = values
