"""The contents of the hub's files, each in a file that is named after its SHA-256."""

from __future__ import annotations

import hashlib
from collections.abc import AsyncIterator
from pathlib import Path
from uuid import uuid4

from anyio import CancelScope

from passo.card.folder import FolderCard
from passo.errors import CardError, InputError
from passo.hub.slicer_facts import SlicerFacts, read_facts
from passo.web.files.comments import Comments
from passo.web.files.incoming import Incoming, in_worker_thread
from passo.web.files.metadata import comments_of


class Contents:
    """A folder with the contents. Use it only in one event loop."""

    def __init__(self, folder: Path) -> None:
        """Makes the folder and removes what an interrupted upload has left. Raises OSError, and
        CardError if the folder cannot be read."""
        folder.mkdir(parents=True, exist_ok=True)
        for entry in folder.iterdir():
            if entry.is_file() and len(entry.stem) != hashlib.sha256().digest_size * 2:
                entry.unlink()
        self._folder, self._card = folder, FolderCard(folder)

    def path(self, sha256: str) -> Path:
        """Where a content is."""
        return self._folder / _name(sha256)

    async def receive(
        self, pieces: AsyncIterator[bytes], total: int | None, expected: str = ""
    ) -> tuple[str, int]:
        """Stores a content of `total` bytes, None if that is unknown; returns its SHA-256 and its
        size when it is durable. Raises InputError for content that is not G-code or does not have
        the `expected` hash, and CardError `card.full`; then nothing remains."""
        path = f"/{uuid4().hex}.gcode"
        incoming = Incoming(self._card, self._card.create(path), path, total)
        incoming.sha256 = expected
        try:
            await incoming.check_space()
            async for piece in pieces:
                await incoming.write(piece)
            if total is not None and incoming.offset != total:
                value = f"it has {incoming.offset} of {total} bytes"
                raise InputError.of("upload.malformed", value=value)
            await incoming.finish()
        except BaseException:
            with CancelScope(shield=True):
                await incoming.abort()
            raise
        sha256 = incoming.digest
        await in_worker_thread(lambda: self._name(path, sha256))
        return sha256, incoming.offset

    async def facts(self, sha256: str) -> SlicerFacts:
        """What the slicer says of a content."""
        return await in_worker_thread(lambda: read_facts(self.path(sha256)))

    async def comments(self, sha256: str) -> Comments:
        """The slicer's comments at the beginning of a content. Raises CardError."""
        return await comments_of(self._card, f"/{_name(sha256)}")

    async def remove(self, sha256: str) -> None:
        """Removes a content, if there is one."""
        await in_worker_thread(lambda: self.path(sha256).unlink(missing_ok=True))

    def close(self) -> None:
        """Releases the folder."""
        self._card.close()

    def _name(self, path: str, sha256: str) -> None:
        try:
            self._card.rename(path, f"/{_name(sha256)}")
        except CardError as error:
            self._card.remove(path)
            if error.problems[0].code != "card.exists":
                raise


def _name(sha256: str) -> str:
    return f"{sha256}.gcode"
