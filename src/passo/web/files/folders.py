"""Makes the folders of a file that a client uploads."""

from __future__ import annotations

from contextlib import suppress
from typing import TYPE_CHECKING

from passo.errors import CardError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from passo.card import Card


def make_folders(card: Card, path: str) -> list[str]:
    """Makes the missing folders of a confined path of a file, and returns those that it made,
    outermost first. Blocks. Raises CardError; then it has made none."""
    made: list[str] = []
    folders = path.split("/")[1:-1]
    for depth in range(1, len(folders) + 1):
        folder = "/" + "/".join(folders[:depth])
        try:
            if not _is_folder(card, folder):
                card.make_directory(folder)
                made.append(folder)
        except CardError as error:
            if error.problems[0].code == "card.exists" and _is_folder(card, folder):
                continue  # another client has just made it
            remove_folders(card, made)
            raise
    return made


def remove_folders(card: Card, made: Sequence[str]) -> None:
    """Deletes folders that `make_folders` has made, except those that others use by now. Blocks.
    Never raises CardError."""
    with suppress(CardError):
        for folder in reversed(made):
            card.remove_directory(folder)


def _is_folder(card: Card, path: str) -> bool:
    """Whether a folder exists; False if nothing has this name. Raises CardError for a file."""
    try:
        entry = card.find(path)
    except CardError as error:
        if error.problems[0].code == "card.not-found":
            return False
        raise
    if not entry.is_directory:
        raise CardError.of("card.not-directory", path)
    return True
