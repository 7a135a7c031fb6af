"""What a print reads its program from: a file of the card or of the computer."""

from __future__ import annotations

from typing import Protocol


class Reader(Protocol):
    """An open file to print."""

    size: int

    def read(self, size: int, /) -> bytes:
        """The next bytes; empty at the end. Raises PassoError."""
        ...

    def seek(self, offset: int, /) -> int:
        """The next read begins here."""
        ...

    def tell(self) -> int:
        """Where the next read begins."""
        ...

    def close(self) -> None:
        """No more reads."""
