"""A mounted FAT32 volume: its clusters, and the dirty mark during each change. While the volume
changes, it is marked as dirty in bit 27 of the table's entry 1 (fatgen103, "FAT Data Structure":
ClnShutBitMask). The FSInfo sector is updated before the mark is removed. A volume that was dirty
when it was mounted stays dirty: a computer must repair what an earlier power cut left.
"""

from __future__ import annotations

import struct

from passo.card.boot import find_volume
from passo.card.device import Device
from passo.card.table import Table
from passo.errors import CardError

_CLEAN = 1 << 27
_INFO_LEAD, _INFO_STRUCT, _INFO_TRAIL = 0x41615252, 0x61417272, 0xAA550000


class Volume:
    """The volume on a device. The constructor finds and checks it (CardError `card.format`)."""

    def __init__(self, device: Device) -> None:
        self.device = device
        self.layout = find_volume(device)
        self.table = Table(device, self.layout)
        self._was_clean = bool(self.table[1] & _CLEAN)
        self._changes = 0
        self._info = self._read_info()

    def read_chain(self, first: int, max_bytes: int) -> tuple[bytearray, list[int]]:
        """The content of a chain, and its clusters; `card.broken` if it has more than
        `max_bytes`."""
        data, clusters = bytearray(), list[int]()
        for cluster in self.table.chain(first):
            if len(data) >= max_bytes:
                raise CardError.of(
                    "card.broken",
                    self.device.path,
                    key="a directory's length",
                    value=f"more than {len(data)} bytes",
                    limit=f"at most {max_bytes}",
                )
            data += self.device.read(self.layout.offset(cluster), self.layout.cluster_bytes)
            clusters.append(cluster)
        return data, clusters

    def write_clusters(self, clusters: list[int], data: bytes | bytearray | memoryview) -> None:
        """Writes clusters, the last one padded with zeros; adjacent clusters are written
        together."""
        size = self.layout.cluster_bytes
        view = memoryview(data)
        begin = 0
        for at in range(1, len(clusters) + 1):
            if at == len(clusters) or clusters[at] != clusters[at - 1] + 1:
                part = view[begin * size : at * size]
                where = self.layout.offset(clusters[begin])
                self.device.write(where, part)
                short = (at - begin) * size - len(part)
                if short:
                    self.device.write(where + len(part), bytes(short))
                begin = at

    def begin(self) -> None:
        """Begins a change: marks the volume as dirty. Each call needs one call of `end`."""
        if self.device.read_only:
            raise CardError.of("card.read-only", self.device.path, value="it is write-protected")
        if not self._changes:
            _ = self.table.free  # counted before the first change
            self._mark(0)
        self._changes += 1

    def end(self) -> None:
        """Ends a change, even one that failed: writes the table and FSInfo, then removes the mark
        unless another change is in progress."""
        self._changes -= 1
        self.table.commit()
        if not self._changes:
            self._write_info()
            self.device.flush()
            self._mark(_CLEAN)

    def settle(self) -> None:
        """A barrier: all changes of the table and of clusters so far are on the medium."""
        self.table.commit()
        self.device.flush()

    def _mark(self, clean: int) -> None:
        if self._was_clean:
            self.table[1] = self.table[1] & ~_CLEAN | clean
            self.settle()

    def _read_info(self) -> bytearray | None:
        """The FSInfo sector if it is one (fatgen103, "FAT32 FSInfo Sector Structure")."""
        if self.layout.info_offset is None:
            return None
        info = self.device.read(self.layout.info_offset, 512)
        signatures = struct.unpack_from("<I480xI", info)
        if (*signatures, *struct.unpack_from("<I", info, 508)) != (
            _INFO_LEAD,
            _INFO_STRUCT,
            _INFO_TRAIL,
        ):
            return None
        self.table.next_free = struct.unpack_from("<I", info, 492)[0]
        return info

    def _write_info(self) -> None:
        if self._info is not None and self.layout.info_offset is not None:
            struct.pack_into("<II", self._info, 488, self.table.free, self.table.next_free)
            self.device.write(self.layout.info_offset, self._info)
