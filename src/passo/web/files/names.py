"""Checks file names from clients: none leads out of the card, and each is valid on any computer."""

from __future__ import annotations

import unicodedata

from passo.card import names
from passo.errors import CardError, InputError
from passo.gcode.program_files import PROGRAMS, is_program

_LONGEST_PATH = 1024  # characters
_BINARY = ".bgcode"
_DEVICES = frozenset(
    ("CON", "PRN", "AUX", "NUL", *(f"{port}{i}" for port in ("COM", "LPT") for i in "123456789¹²³"))
)
"""Microsoft, "Naming Files, Paths, and Namespaces": names of devices on Windows, with any
ending."""


def confined(path: str) -> str:
    """The absolute path on the card for a path from a client, with composed accents (NFC); `/` is
    the root of the card. Raises CardError `card.name` for a forbidden name, including `.` and
    `..`."""
    parts = [part for part in unicodedata.normalize("NFC", path).split("/") if part]
    if len(path) > _LONGEST_PATH:
        limit = f"a path of at most {_LONGEST_PATH} characters"
        raise CardError.of("card.name", value=path[:40] + "…", limit=limit)
    for part in parts:
        if part.partition(".")[0].rstrip().upper() in _DEVICES:
            limit = "a name that is not a device on Windows"
            raise CardError.of("card.name", value=part, limit=limit)
        names.check(part, "")
    return "/" + "/".join(parts)


def cleaned(path: str) -> str:
    """Like `confined`, for a file or folder to create: characters that no name may have become
    `_`."""
    return confined("/".join(names.cleaned(part) for part in path.split("/")))


def program(path: str) -> str:
    """Like `cleaned`, for a file to upload. Also raises InputError if it is not G-code."""
    found = cleaned(path)
    name = found.rpartition("/")[2]
    if not name:
        raise CardError.of("card.name", value=path, limit="the name of a file")
    if name.lower().endswith(_BINARY):
        raise InputError.of("upload.binary", name)
    if not is_program(name):
        raise InputError.of("upload.kind", name, limit=", ".join(PROGRAMS))
    return found
