"""Lookup of names and the list of open files, for both kinds of card."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from typing import TypeVar

from passo.card.api import Entry
from passo.card.names import fold
from passo.errors import CardError

Item = TypeVar("Item")


def lookup(items: Sequence[Item], name: str, entry: Callable[[Item], Entry]) -> Item | None:
    """The item with exactly this name, else with the name in another case, else with it as 8.3
    name."""
    wanted = fold(name)
    tests: tuple[Callable[[Entry], bool], ...] = (
        lambda found: found.name == name,
        lambda found: fold(found.name) == wanted,
        lambda found: found.short_name == wanted,
    )
    for test in tests:
        for item in items:
            if test(entry(item)):
                return item
    return None


class OpenFiles:
    """The files that are open, so that none of them is removed or replaced."""

    def __init__(self) -> None:
        self._read: Counter[str] = Counter()
        self._written: set[str] = set()

    def check(self, path: str, *, to_read: bool = False) -> None:
        """Raises `card.busy` if the file is being written, or, unless `to_read`, if it is being
        read."""
        if fold(path) in self._written:
            raise CardError.of("card.busy", path, value="it is being written")
        if self._read[fold(path)] and not to_read:
            raise CardError.of("card.busy", path, value="it is being read")

    def check_below(self, directory: str) -> None:
        """Raise `card.busy` if a file in a directory, or further down, is being read or written."""
        top = fold(directory) + "/"
        open_ones = [*self._written, *(path for path, count in self._read.items() if count)]
        if path := next((path for path in open_ones if path.startswith(top)), None):
            raise CardError.of("card.busy", directory, value=f"{path} is open")

    def check_move(self, path: str, to: str, *, is_directory: bool) -> None:
        """Raises `card.busy` if the item to move is open, and `card.into-itself`."""
        if not is_directory:
            self.check(path)
        elif fold(to).startswith(fold(path) + "/"):
            raise CardError.of("card.into-itself", path)
        else:
            self.check_below(path)
        self.check(to)

    def begin_read(self, path: str) -> None:
        """Registers a reader; a file may have several."""
        self.check(path, to_read=True)
        self._read[fold(path)] += 1

    def end_read(self, path: str) -> None:
        """Removes a reader that was closed."""
        self._read[fold(path)] -= 1

    def begin_write(self, path: str) -> None:
        """Registers the writer of a file; a file has at most one."""
        self.check(path)
        self._written.add(fold(path))

    def end_write(self, path: str) -> None:
        """Removes the writer, which was closed or could not be opened."""
        self._written.discard(fold(path))
