"""A row of the error catalogue, and its exit status."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum


class ExitStatus(IntEnum):
    """What the `passo` command returns to the shell."""

    DONE = 0
    USAGE = 2
    BAD_CONFIG = 3
    BAD_INPUT = 4
    MACHINE_FAULT = 5


@dataclass(frozen=True, slots=True)
class Entry:
    """One row of the catalogue; `says` is a format string for the values of a problem."""

    part: str
    says: str
    action: str
    status: ExitStatus


def bad_input(part: str, says: str, action: str) -> Entry:
    """A row for an error in a file, a command or another input of the user."""
    return Entry(part, says, action, ExitStatus.BAD_INPUT)
