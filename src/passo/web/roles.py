"""The roles of accounts and keys."""

from __future__ import annotations

from enum import IntEnum


class Role(IntEnum):
    """A role. Each role includes the rights of all lower roles."""

    PUBLIC = 0  # without a log-in
    VIEWER = 1
    OPERATOR = 2
    ADMIN = 3

    def __str__(self) -> str:
        """The name, in lower case."""
        return self.name.lower()
