"""A file that is being uploaded to the card. It is checked, written in worker threads, and visible
when it is complete."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, TypeVar

from anyio import CapacityLimiter, to_thread

from passo.errors import CardError, InputError
from passo.web.files.folders import remove_folders

if TYPE_CHECKING:
    from passo.card import Card, Writer

_T = TypeVar("_T")
_PIECE = 1 << 18  # bytes written at once
_FREE_CHECK = 1 << 22  # bytes between two checks of the free space
RESERVE = 1 << 24
"""Bytes that an upload leaves free, because the journal and the settings may be on the same
medium."""

_HEAD = 1024  # bytes that show the type of a file
_BINARY, _ZIP = b"GCDE", b"PK\x03\x04"

_threads = CapacityLimiter(4)  # a medium that hangs blocks only these threads


async def in_worker_thread(action: Callable[[], _T]) -> _T:
    """Runs a blocking function of the card in a worker thread."""
    return await to_thread.run_sync(action, limiter=_threads)


class Incoming:
    """One file that is being uploaded. `offset` counts the received bytes; `total` is the expected
    number, or None; `folders` are those that were made for it. After an error the upload has ended,
    and the card has its earlier content."""

    def __init__(
        self,
        card: Card,
        writer: Writer,
        path: str,
        total: int | None,
        folders: Sequence[str] = (),
    ) -> None:
        self._card, self._writer, self._folders = card, writer, folders
        self.path, self.total = path, total
        self.offset = 0
        self._waiting = bytearray()
        self._digest = hashlib.sha256()
        self.sha256 = ""
        """The SHA-256 that the file must have, in hexadecimal digits; any if empty."""
        self._written = self._checked = 0

    @property
    def digest(self) -> str:
        """The SHA-256 of the received bytes."""
        return self._digest.hexdigest()

    @property
    def name(self) -> str:
        """The file's name without its folders."""
        return self.path.rpartition("/")[2]

    async def check_space(self, room: int = 0) -> None:
        """Raises CardError `card.full` if the rest does not fit, or if less than `room` bytes would
        remain."""
        left = room if self.total is None else self.total - self._written
        free = await in_worker_thread(lambda: self._card.free_bytes)
        if left + RESERVE > free:
            raise CardError.of("card.full", self.path, value=left + RESERVE, limit=free)

    async def write(self, data: bytes) -> None:
        """Writes the next bytes. Raises CardError, and InputError for a content that is not
        G-code."""
        self.offset += len(data)
        self._waiting += data
        self._digest.update(data)
        if len(self._waiting) >= _PIECE:
            await self._flush()

    async def finish(self) -> None:
        """Completes the file. When this returns, the file is durable and on the card under its
        name. Raises as `write`, and InputError `input.empty` and
        `upload.checksum`."""
        if not self.offset:
            raise InputError.of("input.empty", self.name)
        if self.sha256.strip().lower() not in ("", self.digest):
            raise InputError.of("upload.checksum", self.name, value=self.digest, limit=self.sha256)
        await self._flush()
        await in_worker_thread(self._writer.close)

    async def abort(self) -> None:
        """Discards the upload."""
        await in_worker_thread(self.abort_now)

    def abort_now(self) -> None:
        """Like `abort`, but blocks: call it in a worker thread."""
        self._writer.abort()
        remove_folders(self._card, self._folders)

    async def _flush(self) -> None:
        if not self._written:
            self._check_content()
        if self._written - self._checked >= _FREE_CHECK:
            self._checked = self._written
            await self.check_space()
        data = bytes(self._waiting)
        self._waiting.clear()
        await in_worker_thread(lambda: self._writer.write(data))
        self._written += len(data)

    def _check_content(self) -> None:
        head = bytes(self._waiting[:_HEAD])
        if head.startswith(_BINARY):
            raise InputError.of("upload.binary", self.name)
        if head.startswith(_ZIP):
            raise InputError.of("upload.content", self.name, value="it is an archive")
        if b"\0" in head:
            raise InputError.of("upload.content", self.name, value="it is not a text")
