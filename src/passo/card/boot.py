"""Reads the partition table and the boot sector: the layout of a card.

Source: Microsoft, "FAT: General Overview of On-Disk Format" 1.03 (fatgen103), "Boot Sector and BPB
Structure" and "FAT Type Determination".
"""

from __future__ import annotations

import struct
from dataclasses import dataclass

from passo.card.device import Device
from passo.errors import CardError

_MBR_SECTOR = 512
_SIGNATURE = 0xAA55
_FAT32_TYPES = (0x0B, 0x0C)
_MAX_CLUSTERS = 0x0FFFFFF5

# Bytes per sector, sectors per cluster, reserved sectors, FATs, root entries, sectors (16 bit),
# medium, sectors per FAT (16 bit), sectors per track, heads, hidden sectors, sectors, sectors per
# FAT, flags, version, root cluster, sector of FSInfo.
_BPB = struct.Struct("<11xHBHBHHBHHHIIIHHIH")


@dataclass(frozen=True, slots=True)
class Layout:
    """A FAT32 volume on a device: byte offsets from the start of the device, and sizes."""

    sector_bytes: int
    cluster_bytes: int
    table_offsets: tuple[int, ...]
    """Offsets of the copies of the table. All are written alike; the first is read."""
    table_bytes: int
    data_offset: int
    clusters: int
    """The number of clusters; they are numbered from 2."""
    root: int
    info_offset: int | None
    """Offset of the FSInfo sector, or None."""

    @property
    def last_cluster(self) -> int:
        """The highest number of a cluster; the first is 2."""
        return self.clusters + 1

    def offset(self, cluster: int) -> int:
        """The byte offset at which a cluster begins (fatgen103: FirstSectorofCluster)."""
        return self.data_offset + (cluster - 2) * self.cluster_bytes


def _signature(sector: bytearray) -> int:
    return struct.unpack_from("<H", sector, 510)[0]


def find_volume(device: Device) -> Layout:
    """The volume that fills the device, or its first primary FAT32 partition (0x0B or 0x0C).

    CardError `card.format` names the field that does not fit a FAT32 volume. A volume is FAT32 if
    the 16-bit fields that only FAT12 and FAT16 use are 0. The number of clusters does not matter:
    small volumes are accepted, as by common operating systems.
    """
    if device.size < _MBR_SECTOR:
        raise CardError.of(
            "card.format", device.path, key="size", value=device.size, limit=">= 512 bytes"
        )
    sector = device.read(0, _MBR_SECTOR)
    if _signature(sector) != _SIGNATURE:
        raise CardError.of(
            "card.format",
            device.path,
            key="signature",
            value=f"{_signature(sector):#06x}",
            limit=f"{_SIGNATURE:#x}",
        )
    if sector.startswith(b"EXFAT   ", 3):
        raise CardError.of(
            "card.format", device.path, key="the file system", value="exFAT", limit="FAT32"
        )
    if sector[0] in (0xEB, 0xE9) and struct.unpack_from("<H", sector, 11)[0]:
        return _volume(device, 0, device.size)
    types: list[str] = []
    for at in range(446, 510, 16):
        kind = sector[at + 4]
        start, count = struct.unpack_from("<II", sector, at + 8)
        types.append(f"{kind:02X}")
        if kind in _FAT32_TYPES and start and (start + count) * _MBR_SECTOR <= device.size:
            return _volume(device, start * _MBR_SECTOR, (start + count) * _MBR_SECTOR)
    raise CardError.of(
        "card.format",
        device.path,
        key="the list of partition types",
        value=" ".join(types),
        limit="0B or 0C, wholly on the card",
    )


def _volume(device: Device, start: int, end: int) -> Layout:
    if end - start < _MBR_SECTOR:
        raise CardError.of(
            "card.format", device.path, key="size", value=end - start, limit=">= 512"
        )
    sector = device.read(start, _MBR_SECTOR)

    def require(holds: bool, key: str, value: object, limit: str) -> None:
        if not holds:
            raise CardError.of("card.format", device.path, key=key, value=value, limit=limit)

    (
        sector_bytes,
        per_cluster,
        reserved,
        copies,
        root_entries,
        sectors_16,
        _,
        table_16,
        _,
        _,
        _,
        sectors,
        table_sectors,
        flags,
        version,
        root,
        info,
    ) = _BPB.unpack_from(sector)
    found = _signature(sector)
    require(found == _SIGNATURE, "signature", f"{found:#06x}", f"{_SIGNATURE:#x}")
    require(sector_bytes in (512, 1024, 2048, 4096), "bytes a sector", sector_bytes, "512 to 4096")
    require(per_cluster.bit_count() == 1, "sectors a cluster", per_cluster, "a power of 2")
    require(reserved >= 1, "reserved sectors", reserved, ">= 1")
    require(copies in (1, 2), "number of FATs", copies, "1 or 2")
    require(root_entries == 0, "root entries", root_entries, "0 on FAT32")
    require(table_16 == 0, "sectors a FAT (16 bit)", table_16, "0 on FAT32")
    sectors = sectors_16 or sectors
    require(version == 0, "version", f"{version:#x}", "0")
    room = (end - start) // sector_bytes
    require(0 < sectors <= room, "sectors", sectors, f"1 to {room}, as the card has")
    before = reserved + copies * table_sectors
    require(table_sectors > 0 and before < sectors, "sectors a FAT", table_sectors, "room for data")
    clusters = (sectors - before) // per_cluster
    held = min(table_sectors * sector_bytes // 4 - 2, _MAX_CLUSTERS)
    require(1 <= clusters <= held, "number of clusters", clusters, f"1 to {held}")
    require(2 <= root <= clusters + 1, "root cluster", root, f"2 to {clusters + 1}")
    tables = [start + (reserved + i * table_sectors) * sector_bytes for i in range(copies)]
    if flags & 0x80:  # the copies may differ: only the active one is valid
        active = flags & 0x0F
        require(active < copies, "active FAT", active, f"below {copies}")
        tables = [tables[active]]
    return Layout(
        sector_bytes,
        per_cluster * sector_bytes,
        tuple(tables),
        (clusters + 2) * 4,
        start + before * sector_bytes,
        clusters,
        root,
        start + info * sector_bytes if 0 < info < reserved else None,
    )
