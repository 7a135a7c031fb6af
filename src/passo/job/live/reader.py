"""The interface of an open file to print, on the card or on this computer."""

from __future__ import annotations

from typing import Protocol


class Reader(Protocol):
    """An open file to print."""

    size: int

    def read(self, size: int, /) -> bytes:
        """The next bytes; empty at the end. Raises PassoError."""
        ...

    def seek(self, offset: int, /) -> int:
        """Sets the position of the next read."""
        ...

    def tell(self) -> int:
        """The position of the next read."""
        ...

    def close(self) -> None:
        """Closes the file."""
