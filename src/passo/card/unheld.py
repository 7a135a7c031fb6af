"""A file that is read in pieces and kept closed between them."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING

from passo.card.api import Card
from passo.errors import CardError

if TYPE_CHECKING:
    from _typeshed import WriteableBuffer


class Unheld(io.RawIOBase):
    """A file of a card that is open only during a read, so that it can be replaced or removed
    between two reads. If it was, the next read raises CardError `card.changed` or `card.not-found`.
    After another thread has closed it, the next read raises ValueError.
    """

    def __init__(self, card: Card, path: str) -> None:
        super().__init__()
        self._card, self._path = card, path
        self._entry = card.find(path)
        self.size = self._entry.size
        self._at = 0

    def readable(self) -> bool:
        """Always true: the file is open for reading."""
        return True

    def seekable(self) -> bool:
        """Always true: a position can be set."""
        return True

    def tell(self) -> int:
        """The position in bytes from the beginning."""
        return self._at

    def seek(self, offset: int, whence: int = io.SEEK_SET) -> int:
        """Sets the position to `offset` bytes, which must be within the file."""
        base = {io.SEEK_SET: 0, io.SEEK_CUR: self._at, io.SEEK_END: self.size}[whence]
        self._at = min(max(base + offset, 0), self.size)
        return self._at

    def readinto(self, buffer: WriteableBuffer) -> int:
        """Fills the buffer; returns fewer bytes only at the end of the file. Raises CardError,
        ValueError."""
        if self.closed:
            raise ValueError("the file is closed")
        with self._card.open(self._path) as reader:
            now = self._card.find(self._path)
            if (now.size, now.modified) != (self._entry.size, self._entry.modified):
                value = "it was replaced"
                raise CardError.of("card.changed", self._path, value=value)
            reader.seek(self._at)
            count = reader.readinto(buffer)
        self._at += count
        return count
