"""The interface of a card: entries, readers, writers, and the protocol of all cards."""

from __future__ import annotations

import io
from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from datetime import datetime
from types import TracebackType
from typing import TYPE_CHECKING, Protocol, Self

from passo.errors import CardError

if TYPE_CHECKING:
    from _typeshed import WriteableBuffer


_PIECE = 1 << 20


def is_removed(error: CardError) -> bool:
    """True if the medium failed, so that it is unknown how much of the last step was written."""
    return error.problems[0].code == "card.removed"


@dataclass(frozen=True, slots=True)
class Entry:
    """A file or directory in a listing.

    `name` is the long name and `short_name` the 8.3 form in upper case; both are free of control
    characters. `size` is in bytes, 0 for a directory. `modified` is local time, to 2 s on FAT.
    """

    name: str
    short_name: str
    is_directory: bool
    size: int
    modified: datetime

    @property
    def fat_timestamp(self) -> int:
        """`modified` as FAT's date (high 16 bits) and time (low 16 bits), clamped to the years 1980
        to 2107.

        Microsoft FAT32 File System Specification 1.03, "Date and Time Formats".
        """
        when = self.modified
        if when.year < 1980:
            return 1 << 21 | 1 << 16
        date = (min(when.year, 2107) - 1980) << 9 | when.month << 5 | when.day
        return date << 16 | when.hour << 11 | when.minute << 5 | when.second // 2


class Reader(io.RawIOBase):
    """A file of a card, open for reading. Closing it releases the file for removal.

    `read(n)` returns n bytes, or fewer at the end of the file. The reader has no buffer: read
    pieces of at least 4 KiB, or wrap the reader in `io.BufferedReader`. Every call may raise
    CardError (`card.removed`, `card.broken`).
    """

    def __init__(
        self, size: int, fetch: Callable[[int, memoryview], None], released: Callable[[], None]
    ) -> None:
        """`fetch(offset, into)` fills all of `into`; `released()` is called once, at the end."""
        super().__init__()
        self.size = size
        self._fetch = fetch
        self._released = released
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
        """Sets the position, clamped to 0 to `size`, and returns it in bytes."""
        base = {io.SEEK_SET: 0, io.SEEK_CUR: self._at, io.SEEK_END: self.size}[whence]
        self._at = min(max(base + offset, 0), self.size)
        return self._at

    def readinto(self, buffer: WriteableBuffer) -> int:
        """Fills the buffer from the position on and returns the number of bytes, less than its
        length only where the file ends. Raises CardError, and ValueError after `close`."""
        if self.closed:
            raise ValueError("the file is closed")
        view = memoryview(buffer).cast("B")
        count = min(len(view), self.size - self._at)
        if count:
            self._fetch(self._at, view[:count])
            self._at += count
        return count

    def read(self, size: int = -1) -> bytes:
        """`size` bytes from the position on, or the rest of the file if it is shorter or `size` is
        negative. Raises CardError, and ValueError after `close`."""
        left = self.size - self._at if size < 0 else size
        data = bytearray()
        # Read in pieces, so that a wrong size on a damaged card does not allocate memory.
        while left > 0:
            piece = bytearray(min(left, _PIECE, self.size - self._at))
            if not self.readinto(piece):
                break
            data += piece
            left -= len(piece)
        return bytes(data)

    def close(self) -> None:
        """Releases the file. Closing it again does nothing."""
        if not self.closed:
            self._released()
        super().close()


class Writer(ABC):
    """A file of a card that is being written. The card shows it only after `close` has returned.

    As a context manager it closes the file at the end of the block, and discards it if the block
    raises. Once a call has raised CardError, the file is discarded, and `write` and `close` raise
    the same error again.
    """

    def __init__(self) -> None:
        self._failure: CardError | None = None
        self._ended = False

    def write(self, data: bytes) -> int:
        """Appends `data`; returns its length. CardError: `card.full`, `card.removed`, ..."""
        self._run(lambda: self._append(data))
        return len(data)

    def close(self) -> None:
        """Makes the file durable and visible under its name, in one step; it replaces an older file
        of this name. After it has returned, the file survives a power cut. If it raises, the card
        has its earlier content or the whole new file. A second call does nothing.
        """
        if self._failure or not self._ended:
            self._run(self._store)
            self._ended = True

    def abort(self) -> None:
        """Discards what was written: the card keeps its earlier content. Never raises CardError."""
        if not self._ended:
            self._ended = True
            self._discard()

    def _run(self, step: Callable[[], None]) -> None:
        if self._failure:
            raise self._failure
        if self._ended:
            raise ValueError("the file is closed")
        try:
            step()
        except CardError as error:
            self._failure = error
            self.abort()
            raise

    @abstractmethod
    def _append(self, data: bytes) -> None: ...

    @abstractmethod
    def _store(self) -> None: ...

    @abstractmethod
    def _discard(self) -> None: ...

    def __enter__(self) -> Self:
        """The writer itself."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Closes the file if all went well, else discards it. Raises CardError."""
        if kind is None:
            self.close()
        else:
            self.abort()


class Card(Protocol):
    """Storage for files, with the rules of an SD card. Names in a path are separated by `/`; a
    leading `/` is optional; `.` and `..` are resolved within the path and never lead out of the
    card. A name is looked up first as written, then without regard to case, then as an 8.3 name.
    All calls block for as long as the medium takes: from asyncio, call them through
    `asyncio.to_thread`; calls from several threads wait for each other. All raise CardError, whose
    problem's code begins with `card.`.
    """

    def list(self, directory: str = "/") -> list[Entry]:
        """The entries of a directory, sorted by name without regard to case."""
        ...

    def find(self, path: str) -> Entry:
        """The entry of a file or directory; the root has an empty name."""
        ...

    def open(self, path: str) -> Reader:
        """Opens a file for reading. Until the reader is closed, the file can be neither removed nor
        replaced (`card.busy`)."""
        ...

    def create(self, path: str) -> Writer:
        """Starts to write a new file, or the new content of an existing file. Its directory must
        exist."""
        ...

    def remove(self, path: str) -> None:
        """Deletes a file; durable when this returns."""
        ...

    def rename(self, path: str, to: str) -> None:
        """Renames a file or directory, or moves it to another existing directory; durable when this
        returns. An existing file is not replaced (`card.exists`). After a power cut it has the old
        or the new name; a file of a FAT card may have both, each with the whole content.
        """
        ...

    def make_directory(self, path: str) -> None:
        """Makes a directory in an existing one; durable when this returns."""
        ...

    def remove_directory(self, path: str) -> None:
        """Deletes an empty directory (otherwise `card.not-empty`); durable when this returns."""
        ...

    @property
    def free_bytes(self) -> int:
        """The free space for new files, in bytes."""
        ...

    def close(self) -> None:
        """Releases the card, so that it can be removed; open readers and writers end with
        `card.removed`. A second call does nothing."""
        ...
