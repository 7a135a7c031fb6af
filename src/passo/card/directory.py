"""The 32-byte slots of a directory, decoded and encoded.

Source: Microsoft, "FAT: General Overview of On-Disk Format" 1.03 (fatgen103), "FAT Directory
Structure", "FAT Long Directory Entries".
"""

from __future__ import annotations

import struct
from dataclasses import dataclass, replace
from datetime import datetime

from passo.card.api import Entry
from passo.card.names import MAX_UNITS, is_presentable, stable_short_name

SLOT = 32
MAX_BYTES = 65536 * SLOT
"""The maximum size of a directory in bytes."""

ATTR_READ_ONLY, ATTR_VOLUME, ATTR_DIRECTORY, ATTR_ARCHIVE = 0x01, 0x08, 0x10, 0x20
_ATTR_LONG, _ATTR_LONG_MASK = 0x0F, 0x3F
_LAST_LONG = 0x40
_UNITS = 13
_DELETED = 0xE5
_LOWER_BASE, _LOWER_EXTENSION = 0x08, 0x10

# Name, attributes, lower-case flags, time of creation in 10 ms, time and date of creation, date of
# access, cluster (high), time and date of change, cluster (low), size.
_SHORT = struct.Struct("<11sBBBHHHHHHHI")
_LONG = struct.Struct("<B10sBBB12sH4s")


@dataclass(frozen=True, slots=True)
class Record:
    """A file or directory: its entry, its first cluster (0: none), and its slots."""

    entry: Entry
    attributes: int
    cluster: int
    first_slot: int
    """The first slot of its long name; equal to `slot` without a long name."""
    slot: int
    """The slot of its 8.3 entry."""


@dataclass(frozen=True, slots=True)
class Slots:
    """The content of a directory: its records, and the slot of its end mark (the number of slots if
    there is no mark)."""

    records: list[Record]
    end: int
    data: bytearray
    clusters: list[int]

    @property
    def first_name(self) -> str:
        """Any name in the directory, even a hidden one; empty if the directory is empty."""
        for slot in range(self.end):
            name, attributes = (
                self.data[slot * SLOT : slot * SLOT + 11],
                self.data[slot * SLOT + 11],
            )
            if name[0] not in (_DELETED, ord(".")) and attributes & _ATTR_LONG_MASK != _ATTR_LONG:
                return self.records[0].entry.name if self.records else name.decode("cp437").rstrip()
        return ""

    def free_run(self, count: int, per_sector: int) -> int | None:
        """The first run of `count` deleted slots within one sector, before the end mark."""
        run = 0
        for slot in range(self.end):
            if slot % per_sector == 0:
                run = 0
            run = run + 1 if self.data[slot * SLOT] == _DELETED else 0
            if run == count:
                return slot - count + 1
        return None


def checksum(short: bytes) -> int:
    """The checksum of an 8.3 name, which each part of its long name repeats (fatgen103: ChkSum)."""
    total = 0
    for byte in short:
        total = ((total & 1) << 7 | total >> 1) + byte & 0xFF
    return total


def parse(data: bytearray, clusters: list[int]) -> Slots:
    """The records of a directory without `.`, `..`, volume labels and names that cannot be typed. A
    long name is used if its parts are complete, in order, and have the right checksum.
    """
    records: list[Record] = []
    parts: list[bytes] = []
    expected, total, first = 0, -1, 0
    slots = len(data) // SLOT
    for slot in range(slots):
        at = slot * SLOT
        lead, attributes = data[at], data[at + 11]
        if lead == 0:
            return Slots(_with_ascii_names(records), slot, data, clusters)
        if lead == _DELETED:
            expected, total = 0, -1
        elif attributes & _ATTR_LONG_MASK == _ATTR_LONG:
            order, units, _, _, given, more, _, rest = _LONG.unpack_from(data, at)
            if order & _LAST_LONG:
                parts, expected, total, first = [], order & ~_LAST_LONG, given, slot
            if expected < 1 or order & ~_LAST_LONG != expected or given != total:
                expected, total = 0, -1
            else:
                parts.append(units + more + rest)
                expected -= 1
        else:
            short = bytes(data[at : at + 11])
            long_name = ""
            if total == checksum(short) and expected == 0:
                long_name = _long_name(parts)
            record = _record(data, slot, long_name, first if long_name else slot)
            if record:
                records.append(record)
            expected, total = 0, -1
    return Slots(_with_ascii_names(records), slots, data, clusters)


def _with_ascii_names(records: list[Record]) -> list[Record]:
    """Gives each record an ASCII 8.3 name. Hosts can name a file only in ASCII, and a card does not
    specify the code page of its 8.3 names. If an 8.3 name has other characters, a new one is made
    from the long name."""
    taken = {record.entry.short_name for record in records}
    found: list[Record] = []
    for record in records:
        entry = record.entry
        if not entry.short_name.isascii():
            short = stable_short_name(entry.name, taken)
            taken.add(short)
            record = replace(record, entry=replace(entry, short_name=short))
        found.append(record)
    return found


def _long_name(parts: list[bytes]) -> str:
    units = b"".join(reversed(parts)).decode("utf-16-le", "replace")
    name = units.split("\0", 1)[0]
    return name if is_presentable(name) and "/" not in name and len(name) <= MAX_UNITS else ""


def _record(data: bytearray, slot: int, long_name: str, first_slot: int) -> Record | None:
    raw, attributes, lower, _, _, _, _, high, time, date, low, size = _SHORT.unpack_from(
        data, slot * SLOT
    )
    if attributes & ATTR_VOLUME or raw.startswith(b"."):
        return None
    raw = b"\xe5" + raw[1:] if raw[0] == 0x05 else raw
    base, extension = raw[:8].decode("cp437").rstrip(), raw[8:].decode("cp437").rstrip()
    dot = "." if extension else ""
    short = base + dot + extension
    if not base or not is_presentable(short) or "/" in short:
        return None
    shown = (
        (base.lower() if lower & _LOWER_BASE else base)
        + dot
        + (extension.lower() if lower & _LOWER_EXTENSION else extension)
    )
    is_directory = bool(attributes & ATTR_DIRECTORY)
    entry = Entry(
        long_name or shown, short, is_directory, 0 if is_directory else size, _when(date, time)
    )
    return Record(entry, attributes, (high << 16 | low) & 0x0FFFFFFF, first_slot, slot)


def _when(date: int, time: int) -> datetime:
    try:
        return datetime(
            1980 + (date >> 9),
            date >> 5 & 0x0F,
            date & 0x1F,
            time >> 11,
            time >> 5 & 0x3F,
            2 * (time & 0x1F),
        )
    except ValueError:
        return datetime(1980, 1, 1)


def _packed(short: str) -> bytes:
    base, _, extension = short.partition(".")
    return base.ljust(8).encode("ascii") + extension.ljust(3).encode("ascii")


def build(entry: Entry, attributes: int, cluster: int) -> bytearray:
    """The slots of a new record: its entry, and its long name unless the 8.3 name is the same."""
    short = _packed(entry.short_name)
    data = bytearray()
    if entry.name != entry.short_name:
        units = entry.name.encode("utf-16-le")
        if len(units) % (2 * _UNITS):
            units = (units + b"\0\0").ljust(-(-len(units) // 26) * 26, b"\xff")
        count = len(units) // (2 * _UNITS)
        for order in range(count, 0, -1):
            part = units[(order - 1) * 26 : order * 26]
            lead = order | (_LAST_LONG if order == count else 0)
            data += _LONG.pack(
                lead, part[:10], _ATTR_LONG, 0, checksum(short), part[10:22], 0, part[22:]
            )
    return data + short_entry(short, entry, attributes, cluster)


def dots(cluster: int, parent: int, modified: datetime) -> bytearray:
    """The first two slots of a new directory; `parent` is 0 for the root."""
    entry = Entry("", "", True, 0, modified)
    return short_entry(b".".ljust(11), entry, ATTR_DIRECTORY, cluster) + short_entry(
        b"..".ljust(11), entry, ATTR_DIRECTORY, parent
    )


def short_entry(name: bytes, entry: Entry, attributes: int, cluster: int) -> bytearray:
    """A slot with an 8.3 name."""
    date, time = entry.fat_timestamp >> 16, entry.fat_timestamp & 0xFFFF
    return bytearray(
        _SHORT.pack(
            name,
            attributes,
            0,
            0,
            time,
            date,
            date,
            cluster >> 16,
            time,
            date,
            cluster & 0xFFFF,
            entry.size,
        )
    )


def rewritten(slot: bytes, size: int, cluster: int, modified: datetime) -> bytes:
    """A copy of a file's slot with a new size, first cluster and time of change; sets the archive
    bit."""
    name, attributes, lower, tenths, ctime, cdate, *_ = _SHORT.unpack(slot)
    stamp = Entry("", "", False, size, modified).fat_timestamp
    return _SHORT.pack(
        name,
        attributes | ATTR_ARCHIVE,
        lower,
        tenths,
        ctime,
        cdate,
        stamp >> 16,
        cluster >> 16,
        stamp & 0xFFFF,
        stamp >> 16,
        cluster & 0xFFFF,
        size,
    )
