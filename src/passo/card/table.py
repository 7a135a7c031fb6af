"""The file allocation table: chains of clusters, free clusters, and its copies on the card.

Source: Microsoft, "FAT: General Overview of On-Disk Format" 1.03 (fatgen103), "FAT Data Structure".
"""

from __future__ import annotations

import sys
from array import array
from collections.abc import Iterator

from passo.card.boot import Layout
from passo.card.device import Device
from passo.errors import CardError

END = 0x0FFFFFFF
_FIRST_END = 0x0FFFFFF8
_MASK = 0x0FFFFFFF
_CACHED_SECTORS = 512
_COUNTED_BYTES = 1 << 20


def _entries(data: bytes | bytearray) -> array[int]:
    entries = array("I")
    entries.frombytes(data)
    if sys.byteorder == "big":
        entries.byteswap()
    return entries


def _bytes(entries: array[int]) -> bytes:
    if sys.byteorder == "big":
        entries = entries[:]
        entries.byteswap()
    return entries.tobytes()


class Table:
    """The table of a volume. Changes stay in memory until `commit`, which writes every copy."""

    def __init__(self, device: Device, layout: Layout) -> None:
        self._device = device
        self._layout = layout
        self._per_sector = layout.sector_bytes // 4
        self._sectors: dict[int, array[int]] = {}
        self._changed: set[int] = set()
        self._free: int | None = None
        self.next_free = 2

    def __getitem__(self, cluster: int) -> int:
        """The 28 bits of an entry."""
        sector, at = divmod(cluster, self._per_sector)
        return self._sector(sector)[at] & _MASK

    def __setitem__(self, cluster: int, value: int) -> None:
        """Change the 28 bits of an entry; the upper 4 bits are kept, as fatgen103 requires."""
        number, at = divmod(cluster, self._per_sector)
        sector = self._sector(number)
        old = sector[at]
        sector[at] = value | old & ~_MASK
        self._changed.add(number)
        if self._free is not None and cluster >= 2:
            self._free += (sector[at] == 0) - (old == 0)
        if len(self._changed) >= _CACHED_SECTORS // 2:
            self.commit()

    def _sector(self, number: int) -> array[int]:
        sector = self._sectors.get(number)
        if sector is None:
            size = self._layout.sector_bytes
            at = self._layout.table_offsets[0] + number * size
            sector = _entries(self._device.read(at, size))
            self._sectors[number] = sector
            if len(self._sectors) > _CACHED_SECTORS:
                oldest = next(key for key in self._sectors if key not in self._changed)
                del self._sectors[oldest]
        return sector

    def commit(self) -> None:
        """Write the changed sectors to every copy of the table."""
        for number in sorted(self._changed):
            data = _bytes(self._sectors[number])
            for table in self._layout.table_offsets:
                self._device.write(table + number * self._layout.sector_bytes, data)
        self._changed.clear()

    def chain(self, first: int) -> Iterator[int]:
        """The clusters of a chain. CardError `card.broken` if the chain leaves the volume, reaches
        a free or bad cluster, or has a loop. Brent's cycle detection finds a loop without extra
        memory."""
        last = self._layout.last_cluster
        cluster, mark, steps, limit = first, 0, 0, 1
        while True:
            if not 2 <= cluster <= last:
                raise self._broken("a cluster number", f"{cluster:#x}", f"2 to {last}")
            if cluster == mark:
                raise self._broken("a cluster chain", f"a loop at {cluster}", "an end")
            yield cluster
            steps += 1
            if steps == limit:
                mark, steps, limit = cluster, 0, 2 * limit
            cluster = self[cluster]
            if cluster >= _FIRST_END:
                return

    def _broken(self, key: str, value: str, limit: str) -> Exception:
        return CardError.of("card.broken", self._device.path, key=key, value=value, limit=limit)

    @property
    def free(self) -> int:
        """The number of free clusters, counted at the first use, because FSInfo is only a hint."""
        if self._free is None:
            self.commit()
            free, at = 0, 8
            while at < self._layout.table_bytes:
                count = min(_COUNTED_BYTES, self._layout.table_bytes - at)
                part = self._device.read(self._layout.table_offsets[0] + at, count)
                free += _entries(part).count(0)
                at += count
            self._free = free
        return self._free

    def allocate(self, count: int) -> list[int]:
        """Takes free clusters after the last one taken, and makes them a new chain.

        CardError `card.full` if there are not enough; nothing is taken then.
        """
        if count > self.free:
            size = self._layout.cluster_bytes
            raise CardError.of(
                "card.full", self._device.path, value=count * size, limit=self.free * size
            )
        taken: list[int] = []
        cluster = self.next_free
        while len(taken) < count:
            cluster = self._free_from(cluster)
            self[cluster] = END
            if taken:
                self[taken[-1]] = cluster
            taken.append(cluster)
            cluster += 1
        self.next_free = cluster
        return taken

    def _free_from(self, cluster: int) -> int:
        """The first free cluster at or after this one; the search wraps around at the end of the
        volume."""
        last = self._layout.last_cluster
        if not 2 <= cluster <= last:
            cluster = 2
        number, at = divmod(cluster, self._per_sector)
        sectors = last // self._per_sector + 1
        for _ in range(sectors + 1):
            sector = self._sector(number)
            end = min(len(sector), last + 1 - number * self._per_sector)
            try:
                return number * self._per_sector + sector.index(0, at, end)
            except ValueError:
                number = (number + 1) % sectors
                at = 2 if number == 0 else 0
        raise self._broken("the number of free clusters", str(self._free), "0")

    def release(self, first: int) -> None:
        """Frees a chain that `check` has accepted, from its head on."""
        previous = 0
        for cluster in self.chain(first):
            if previous:
                self[previous] = 0
            previous = cluster
        self[previous] = 0

    def check(self, first: int) -> None:
        """Raises `card.broken` unless the chain is complete."""
        for _ in self.chain(first):
            pass
