"""Directories on the volume, changed so that after a power cut a directory has its old or its new
state.

A record is placed in one sector if it fits, because the medium writes a sector as a whole. A record
that needs more (names of more than 195 letters, with sectors of 512 bytes) is added with its 8.3
entry last, and deleted with its 8.3 entry first: a power cut may leave a part of a long name, which
has no effect. The clusters of a record are on the medium before the record is written.
"""

from __future__ import annotations

from datetime import datetime

from passo.card.directory import MAX_BYTES, SLOT, Record, Slots, parse, rewritten
from passo.card.volume import Volume
from passo.errors import CardError

_DELETED = b"\xe5"


class Directories:
    """Reads and changes the directories of a volume; a directory is named by its first cluster."""

    def __init__(self, volume: Volume) -> None:
        self._volume = volume
        self._sector = volume.layout.sector_bytes

    def load(self, first: int) -> Slots:
        """Reads a directory. CardError `card.broken` if its chain is incomplete or too long."""
        return parse(*self._volume.read_chain(first, MAX_BYTES))

    def insert(self, slots: Slots, record: bytes | bytearray) -> None:
        """Adds a record to a directory, and lengthens the directory if necessary (`card.full`)."""
        count, per_sector = len(record) // SLOT, self._sector // SLOT
        data = bytearray(slots.data)
        start = slots.free_run(count, per_sector)
        begin = slots.end
        if start is None:
            start = begin
            if count <= per_sector and start % per_sector + count > per_sector:
                start += per_sector - start % per_sector
            self._lengthen(slots, data, start + count)
            for slot in range(begin, start):
                data[slot * SLOT : (slot + 1) * SLOT] = _DELETED.ljust(SLOT, b"\0")
            # The bytes after the old end mark are undefined: place the new mark after the record.
            stop = -(-(start + count) // per_sector) * self._sector
            data[(start + count) * SLOT : stop] = bytes(stop - (start + count) * SLOT)
            self._clear_behind(slots, begin, start + count)
        else:
            begin = start
        data[start * SLOT : (start + count) * SLOT] = record
        for sector in self._sectors(begin, start + count):
            self._write_sector(slots, data, sector)

    def rewrite(self, slots: Slots, record: Record, size: int, first: int, now: datetime) -> None:
        """Points the record of a file to a new content, in one write."""
        data = bytearray(slots.data)
        at = record.slot * SLOT
        data[at : at + SLOT] = rewritten(bytes(data[at : at + SLOT]), size, first, now)
        self._write_sector(slots, data, at // self._sector)

    def replace(self, slots: Slots, record: Record, new: bytes | bytearray) -> bool:
        """Replaces a record by another one, in one write. Returns False, without any change, if the
        sector has no space for it."""
        data, per_sector = bytearray(slots.data), self._sector // SLOT
        count, sector = len(new) // SLOT, record.slot // per_sector
        begin, end = record.first_slot, record.slot + 1
        first, last = sector * per_sector, (sector + 1) * per_sector
        if begin < first:
            return False
        while begin > first and data[(begin - 1) * SLOT] == _DELETED[0]:
            begin -= 1
        while end < last and (end >= slots.end or data[end * SLOT] == _DELETED[0]):
            end += 1
        if end - begin < count:
            return False
        start = min(record.first_slot, end - count)
        stop = start + count
        for slot in range(record.first_slot, record.slot + 1):
            data[slot * SLOT] = _DELETED[0]
        data[start * SLOT : stop * SLOT] = new
        if stop > slots.end:  # the end mark moves; the bytes after it are undefined
            if stop == last and any(data[last * SLOT : last * SLOT + 1]):
                return False
            data[stop * SLOT : last * SLOT] = bytes((last - stop) * SLOT)
        self._write_sector(slots, data, sector)
        return True

    def delete(self, slots: Slots, record: Record) -> None:
        """Deletes a record: first its 8.3 entry, which deletes the file, then the rest."""
        data = bytearray(slots.data)
        for slot in range(record.first_slot, record.slot + 1):
            data[slot * SLOT] = _DELETED[0]
        for sector in reversed(self._sectors(record.first_slot, record.slot + 1)):
            self._write_sector(slots, data, sector)

    def _lengthen(self, slots: Slots, data: bytearray, needed: int) -> None:
        """Appends empty clusters until there is space for `needed` slots."""
        missing = needed * SLOT - len(data)
        if missing <= 0:
            return
        size = self._volume.layout.cluster_bytes
        if needed * SLOT > MAX_BYTES:
            raise CardError.of(
                "card.too-long", self._volume.device.path, value=needed * SLOT, limit=MAX_BYTES
            )
        added = self._volume.table.allocate(-(-missing // size))
        self._volume.write_clusters(added, bytes(len(added) * size))
        self._volume.settle()
        self._volume.table[slots.clusters[-1]] = added[0]
        self._volume.settle()
        slots.clusters.extend(added)
        data.extend(bytes(len(added) * size))

    def _clear_behind(self, slots: Slots, begin: int, end: int) -> None:
        """Clears the sectors after that of the end mark, into which the record will extend."""
        for sector in self._sectors(begin, end)[1:]:
            if any(slots.data[sector * self._sector : (sector + 1) * self._sector]):
                self._write_sector(slots, bytearray((sector + 1) * self._sector), sector)

    def _sectors(self, begin: int, end: int) -> range:
        """The directory's sectors that hold these slots."""
        return range(begin * SLOT // self._sector, (end * SLOT - 1) // self._sector + 1)

    def _write_sector(self, slots: Slots, data: bytearray, sector: int) -> None:
        """Writes a sector of the directory before any later write."""
        per_cluster = self._volume.layout.cluster_bytes // self._sector
        cluster = slots.clusters[sector // per_cluster]
        where = self._volume.layout.offset(cluster) + sector % per_cluster * self._sector
        part = memoryview(data)[sector * self._sector : (sector + 1) * self._sector]
        self._volume.device.write(where, part)
        self._volume.device.flush()
