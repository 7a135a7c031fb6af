"""Directories on the volume, changed so that a power cut leaves them as before or as after.

A record goes into one sector where it fits, because a sector is what the medium writes as a whole;
one that needs more (names beyond 195 letters) is written from its last sector to its first. Before
a record appears all that it points to is on the medium.
"""

from __future__ import annotations

from datetime import datetime

from passo.card.api import failure
from passo.card.directory import MAX_BYTES, SLOT, Record, Slots, parse, rewritten
from passo.card.volume import Volume

_DELETED = b"\xe5"


class Directories:
    """Reads and changes the directories of a volume; one is named by its first cluster."""

    def __init__(self, volume: Volume) -> None:
        self._volume = volume
        self._sector = volume.layout.sector_bytes

    def load(self, first: int) -> Slots:
        """CardError `card.broken` if its chain is not whole or too long."""
        return parse(*self._volume.read_chain(first, MAX_BYTES))

    def insert(self, slots: Slots, record: bytes | bytearray) -> None:
        """Put a new record into a directory, lengthened if need be (`card.full`)."""
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
            # What follows the old end mark may be anything: the new one stands behind the record.
            stop = -(-(start + count) // per_sector) * self._sector
            data[(start + count) * SLOT : stop] = bytes(stop - (start + count) * SLOT)
        else:
            begin = start
        data[start * SLOT : (start + count) * SLOT] = record
        self._write_sectors(slots, data, begin, start + count)

    def rewrite(self, slots: Slots, record: Record, size: int, first: int, now: datetime) -> None:
        """Give a file a new content, in one write."""
        data = bytearray(slots.data)
        at = record.slot * SLOT
        data[at : at + SLOT] = rewritten(bytes(data[at : at + SLOT]), size, first, now)
        self._write_sectors(slots, data, record.slot, record.slot + 1)

    def delete(self, slots: Slots, record: Record) -> None:
        """Take a record out: first its 8.3 entry, by which the file goes, then the rest."""
        data = bytearray(slots.data)
        for slot in range(record.first_slot, record.slot + 1):
            data[slot * SLOT] = _DELETED[0]
        self._write_sectors(slots, data, record.first_slot, record.slot + 1)

    def _lengthen(self, slots: Slots, data: bytearray, needed: int) -> None:
        """Append empty clusters until `needed` slots have room."""
        missing = needed * SLOT - len(data)
        if missing <= 0:
            return
        size = self._volume.layout.cluster_bytes
        if needed * SLOT > MAX_BYTES:
            raise failure(
                "card.too-long", self._volume.device.path, value=needed * SLOT, limit=MAX_BYTES
            )
        added = self._volume.table.allocate(-(-missing // size))
        self._volume.write_clusters(added, bytes(len(added) * size))
        self._volume.settle()
        self._volume.table[slots.clusters[-1]] = added[0]
        self._volume.settle()
        slots.clusters.extend(added)
        data.extend(bytes(len(added) * size))

    def _write_sectors(self, slots: Slots, data: bytearray, begin: int, end: int) -> None:
        """Write the sectors that hold these slots, the last first, each before the next."""
        per_cluster = self._volume.layout.cluster_bytes // self._sector
        first, last = begin * SLOT // self._sector, (end * SLOT - 1) // self._sector
        for sector in range(last, first - 1, -1):
            cluster = slots.clusters[sector // per_cluster]
            where = self._volume.layout.offset(cluster) + sector % per_cluster * self._sector
            self._volume.device.write(
                where, memoryview(data)[sector * self._sector : (sector + 1) * self._sector]
            )
            self._volume.device.flush()
