"""Reads and writes the content of files on a FAT32 volume."""

from __future__ import annotations

import threading
from array import array
from bisect import bisect_right
from collections.abc import Callable, Iterator
from contextlib import suppress
from itertools import islice

from passo.card.api import Writer, is_removed
from passo.card.volume import Volume
from passo.errors import CardError

MAX_BYTES = 0xFFFFFFFF
"""The maximum size of a file: the field has 32 bits."""

_PIECE = 256 * 1024


class Extents:
    """The runs of adjacent clusters of a file, followed only as far as the file was read."""

    def __init__(self, volume: Volume, first: int, size: int, path: str) -> None:
        self._volume = volume
        self._path = path
        self._needed = -(-size // volume.layout.cluster_bytes)
        self._first = first
        self._chain: Iterator[int] = volume.table.chain(first)
        self._known = 0
        self._index = array("I")
        """For each run, the index in the file of its first cluster."""
        self._start = array("I")
        self._next = 0

    def read_into(self, offset: int, into: memoryview) -> None:
        """Fills `into` with the file's bytes from `offset` on. Raises CardError `card.broken` or
        `card.removed`."""
        size = self._volume.layout.cluster_bytes
        self._follow((offset + len(into) - 1) // size + 1)
        while into:
            cluster, inside = divmod(offset, size)
            run = bisect_right(self._index, cluster) - 1
            end = self._index[run + 1] if run + 1 < len(self._index) else self._known
            count = min(len(into), (end - cluster) * size - inside)
            start = self._start[run] + cluster - self._index[run]
            self._volume.device.read_into(self._volume.layout.offset(start) + inside, into[:count])
            offset += count
            into = into[count:]

    def _follow(self, until: int) -> None:
        while self._known < until:
            try:
                cluster = next(self._chain, 0)
            except CardError:
                # The reader stays open, so that a caller can try again once the card is back.
                chain = self._volume.table.chain(self._first)
                self._chain = islice(chain, self._known, None)
                raise
            if not cluster:
                raise CardError.of(
                    "card.broken",
                    self._path,
                    key="the cluster chain",
                    value=f"{self._known} long",
                    limit=str(self._needed),
                )
            if cluster != self._next:
                self._index.append(self._known)
                self._start.append(cluster)
            self._next = cluster + 1
            self._known += 1


class FatWriter(Writer):
    """Writes clusters that belong to no directory entry until `store` makes the entry for all of
    them."""

    def __init__(
        self,
        volume: Volume,
        path: str,
        store: Callable[[int, int], None],
        released: Callable[[], None],
        lock: threading.RLock,
    ) -> None:
        """`store(first cluster or 0, size)` makes the directory's record; `released()` is called
        once, when the writer has ended. Every step holds the card's `lock`."""
        super().__init__()
        self._volume = volume
        self._path = path
        self._put = store
        self._released: Callable[[], None] | None = released
        self._lock = lock
        self._waiting = bytearray()
        self._size = 0
        self._first = self._last = 0
        volume.begin()

    def give_up(self, error: CardError) -> None:
        """Ends the writer because the card is unmounted; later calls raise `error`."""
        self.abort()
        self._failure = error

    def _append(self, data: bytes) -> None:
        size = self._size + len(data)
        if size > MAX_BYTES:
            raise CardError.of("card.too-long", self._path, value=size, limit=MAX_BYTES)
        self._size = size
        self._waiting += data
        piece = max(_PIECE, self._volume.layout.cluster_bytes)
        whole = len(self._waiting) // piece * piece
        if whole:
            with self._lock:
                self._flush(whole)

    def _flush(self, count: int) -> None:
        table = self._volume.table
        with memoryview(self._waiting) as view:
            taken = table.allocate(-(-count // self._volume.layout.cluster_bytes))
            if self._last:
                table[self._last] = taken[0]
            self._first = self._first or taken[0]
            self._last = taken[-1]
            self._volume.write_clusters(taken, view[:count])
        table.commit()
        del self._waiting[:count]

    def _store(self) -> None:
        with self._lock:
            if self._waiting:
                self._flush(len(self._waiting))
            self._volume.settle()
            try:
                self._put(self._first, self._size)
            except CardError as error:
                if is_removed(error):  # the record may be on the medium, so keep its clusters
                    self._first = 0
                raise
            self._first = 0
            self._finish()

    def _discard(self) -> None:
        # If the card is gone or damaged, the written data remains as lost clusters.
        with self._lock, suppress(CardError):
            try:
                if self._first:
                    self._volume.table.release(self._first)
            finally:
                self._finish()

    def _finish(self) -> None:
        released, self._released = self._released, None
        if released:
            released()
            self._volume.end()
