"""A file that is read in pieces and kept closed between them."""

from __future__ import annotations

from passo.card.api import Card, Reader
from passo.errors import CardError


class Unheld(Reader):
    """A file of a card that is open only during a read, so that it can be replaced or removed
    between two reads. If it was, the next read raises CardError `card.changed` or `card.not-found`.
    After another thread has closed it, the next read raises ValueError.
    """

    def __init__(self, card: Card, path: str) -> None:
        self._card, self._path = card, path
        self._entry = card.find(path)
        super().__init__(self._entry.size, self._read, lambda: None)

    def _read(self, offset: int, into: memoryview) -> None:
        with self._card.open(self._path) as reader:
            now = self._card.find(self._path)
            if (now.size, now.modified) != (self._entry.size, self._entry.modified):
                raise CardError.of("card.changed", self._path, value="it was replaced")
            reader.seek(offset)
            reader.readinto(into)
