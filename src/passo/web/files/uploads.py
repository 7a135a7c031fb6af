"""The uploads to the card; an interrupted upload can be resumed for `KEPT_S`."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncGenerator, Callable
from contextlib import asynccontextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING

from anyio import CancelScope

from passo.card.names import fold
from passo.errors import InputError, PassoError
from passo.web.files.folders import make_folders, remove_folders
from passo.web.files.incoming import Incoming, in_worker_thread

if TYPE_CHECKING:
    from passo.web.bridge import Bridge

MAX_UPLOADS = 8  # at once, including interrupted ones
KEPT_S = 600.0  # time in which an interrupted upload can be resumed


@dataclass(frozen=True, slots=True)
class _Kept:
    incoming: Incoming
    end: asyncio.TimerHandle


class Uploads:
    """The uploads of one printer. Use it only in the web's event loop."""

    def __init__(self, bridge: Bridge, arrived: Callable[[str], object]) -> None:
        """`arrived` is called with the path of each complete file."""
        self._bridge, self._arrived = bridge, arrived
        self._active = 0
        self._kept: dict[str, _Kept] = {}

    def kept(self, path: str) -> Incoming | None:
        """The interrupted upload of a confined path, which can continue at its offset; None without
        one."""
        found = self._kept.get(fold(path))
        return found and found.incoming

    @asynccontextmanager
    async def file(
        self,
        path: str,
        *,
        total: int | None = None,
        offset: int = 0,
        resumable: bool = False,
        room: int = 0,
    ) -> AsyncGenerator[Incoming]:
        """Uploads a file to a confined path within the block, from `offset` on, and makes the
        folders of the path that do not exist. At the end of the block, the file is put on the card
        if `total` bytes have arrived, or if `total` is None. An incomplete `resumable` upload is
        kept for `KEPT_S`, even if the connection was lost. `room` is the free space, in bytes, that
        must remain on the card after the upload. Raises CardError, CommandError for a file that is
        being printed, InputError `upload.too-many`, `upload.offset`, and the errors of `Incoming`;
        then the card keeps its earlier content.
        """
        self._active += 1
        try:
            if self._active + len(self._kept) > MAX_UPLOADS:
                raise InputError.of("upload.too-many", limit=MAX_UPLOADS)
            incoming = await self._begin(path, total, offset, room)
            try:
                yield incoming
                if total is None or incoming.offset == total:
                    await incoming.finish()
                    self._arrived(path)
                elif incoming.offset > total or not resumable:
                    raise InputError.of(
                        "upload.malformed", value=f"it has {incoming.offset} of {total} bytes"
                    )
                else:
                    self._keep(incoming)
            except BaseException as error:
                lost = not isinstance(error, PassoError) or _is_slow(error)
                if resumable and lost and total is not None and incoming.offset < total:
                    self._keep(incoming)
                else:
                    with CancelScope(shield=True):
                        await incoming.abort()
                raise
        finally:
            self._active -= 1

    async def forget(self, path: str) -> None:
        """Discards the interrupted upload of a confined path."""
        if kept := self._kept.pop(fold(path), None):
            kept.end.cancel()
            await kept.incoming.abort()

    async def _begin(self, path: str, total: int | None, offset: int, room: int) -> Incoming:
        if offset:
            kept = self._kept.get(fold(path))
            at = kept.incoming.offset if kept is not None and kept.incoming.total == total else 0
            if kept is None or at != offset:
                raise InputError.of("upload.offset", path, value=offset, limit=at)
            kept.end.cancel()
            del self._kept[fold(path)]
            return kept.incoming
        await self.forget(path)
        card = await self._bridge.card()
        folders = await in_worker_thread(lambda: make_folders(card, path))
        try:
            writer = await self._bridge.create_file(path)
        except BaseException:
            with CancelScope(shield=True):
                await in_worker_thread(lambda: remove_folders(card, folders))
            raise
        incoming = Incoming(card, writer, path, total, folders)
        try:
            await incoming.check_space(room)
        except BaseException:
            with CancelScope(shield=True):
                await incoming.abort()
            raise
        return incoming

    def _keep(self, incoming: Incoming) -> None:
        loop, key = asyncio.get_running_loop(), fold(incoming.path)

        def forget() -> None:
            del self._kept[key]
            loop.run_in_executor(None, incoming.abort_now)

        self._kept[key] = _Kept(incoming, loop.call_later(KEPT_S, forget))


def _is_slow(error: PassoError) -> bool:
    return error.problems[0].code == "upload.slow"
