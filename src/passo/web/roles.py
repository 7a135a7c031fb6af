"""What accounts and keys may do."""

from __future__ import annotations

from enum import IntEnum


class Role(IntEnum):
    """Who may do it. Each role may do what those before it may."""

    PUBLIC = 0  # without a log-in
    VIEWER = 1
    OPERATOR = 2
    ADMIN = 3

    def __str__(self) -> str:
        """The name, in lower case."""
        return self.name.lower()
