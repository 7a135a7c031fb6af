"""A FAT32 image or block device as a card, read and written."""

from __future__ import annotations

import threading
from collections.abc import Callable, Generator
from contextlib import contextmanager
from dataclasses import replace
from datetime import datetime
from pathlib import Path

from passo.card import names
from passo.card.api import Card, Entry, Reader, Writer, is_removed
from passo.card.device import Device
from passo.card.directories import Directories
from passo.card.directory import (
    ATTR_ARCHIVE,
    ATTR_DIRECTORY,
    ATTR_READ_ONLY,
    Record,
    Slots,
    build,
    dots,
)
from passo.card.fat_files import Extents, FatWriter
from passo.card.tree import OpenFiles, lookup
from passo.card.volume import Volume
from passo.errors import CardError

_PIECE = 1 << 18  # bytes copied at once


class FatCard(Card):
    """The FAT32 volume of an image or block device: its first primary FAT32 partition, or the whole
    device."""

    def __init__(self, path: str | Path, now: Callable[[], datetime] = datetime.now) -> None:
        """`now()` is the local time that new files get.

        Raises CardError: `card.absent`, `card.busy` (mounted, or a card elsewhere), `card.format`.
        """
        self._now = now
        self._lock = threading.RLock()
        self._files = OpenFiles()
        self._writers: set[FatWriter] = set()
        self._device = Device(path)
        try:
            self._volume = Volume(self._device)
        except BaseException:
            self._device.close()
            raise
        self._directories = Directories(self._volume)

    def list(self, directory: str = "/") -> list[Entry]:
        """Like `Card.list`."""
        with self._lock:
            first, _ = self._directory(names.split(directory))
            entries = [record.entry for record in self._directories.load(first).records]
        return sorted(entries, key=lambda entry: (names.fold(entry.name), entry.name))

    def find(self, path: str) -> Entry:
        """Like `Card.find`; the root has no name."""
        parts = names.split(path)
        if not parts:
            return Entry("", "", True, 0, datetime(1980, 1, 1))
        with self._lock:
            return self._existing(*self._directory(parts[:-1]), parts[-1])[1].entry

    def open(self, path: str) -> Reader:
        """Like `Card.open`; several readers may have a file open."""
        with self._file(path) as (first, where, name):
            record = self._existing(first, where, name)[1]
            full = f"{where}/{record.entry.name}"
            if record.entry.is_directory:
                raise CardError.of("card.directory", full)
            self._files.begin_read(full)
        extents = Extents(self._volume, record.cluster, record.entry.size, full)

        def fetch(offset: int, into: memoryview) -> None:
            with self._lock:
                extents.read_into(offset, into)

        def released() -> None:
            with self._lock:
                self._files.end_read(full)

        return Reader(record.entry.size, fetch, released)

    def create(self, path: str) -> Writer:
        """Like `Card.create`. A file that is replaced stays until the new one is complete."""
        with self._file(path) as (first, where, name):
            found = self._lookup(self._directories.load(first), name)
            if found:
                name = found.entry.name
                self._check_replaceable(found, f"{where}/{name}")
            else:
                names.check(name, path)
            full = f"{where}/{name}"
            self._files.begin_write(full)

            def released() -> None:
                self._files.end_write(full)
                self._writers.discard(writer)

            try:
                writer = FatWriter(
                    self._volume,
                    full,
                    lambda cluster, size: self._store(first, where, name, cluster, size),
                    released,
                    self._lock,
                )
            except BaseException:
                self._files.end_write(full)
                raise
            self._writers.add(writer)
            return writer

    def remove(self, path: str) -> None:
        """Like `Card.remove`: deletes the entry first, then frees the clusters."""
        with self._file(path) as (first, where, name):
            slots, record = self._existing(first, where, name)
            full = f"{where}/{record.entry.name}"
            self._check_replaceable(record, full)
            self._files.check(full)
            if record.cluster:
                self._volume.table.check(record.cluster)
            with self._changing():
                self._directories.delete(slots, record)
                if record.cluster:
                    self._volume.table.release(record.cluster)

    def make_directory(self, path: str) -> None:
        """Like `Card.make_directory`; it takes a cluster."""
        with self._file(path) as (first, where, name):
            slots = self._directories.load(first)
            found = self._lookup(slots, name)
            if found:
                raise CardError.of("card.exists", f"{where}/{found.entry.name}")
            names.check(name, path)
            with self._changing():
                entry = self._new_entry(slots, name, is_directory=True, size=0)
                cluster = self._volume.table.allocate(1)
                parent = 0 if first == self._volume.layout.root else first
                try:
                    self._volume.write_clusters(cluster, dots(cluster[0], parent, entry.modified))
                    self._volume.settle()
                    self._directories.insert(slots, build(entry, ATTR_DIRECTORY, cluster[0]))
                except CardError as error:
                    if not is_removed(error):
                        self._volume.table.release(cluster[0])
                    raise

    def rename(self, path: str, to: str) -> None:
        """Like `Card.rename`, in one write if the directory's sector has space for the new name.
        Otherwise a file is copied, which needs free space, and a directory keeps its name
        (`card.no-slots`)."""
        with self._lock:
            if self._rename_in_place(path, to):
                return
            reader, writer = self.open(path), self.create(to)
        with reader, writer:
            while data := reader.read(_PIECE):
                writer.write(data)
        self.remove(path)

    def _rename_in_place(self, path: str, to: str) -> bool:
        """Renames in one write. False if the file must be copied instead."""
        with self._file(path) as (first, where, name), self._file(to) as (target, there, new):
            slots, record = self._existing(first, where, name)
            entry = record.entry
            found = self._lookup(self._directories.load(target), new)
            if found and (where, entry.name) != (there, found.entry.name):
                raise CardError.of("card.exists", f"{there}/{found.entry.name}")
            names.check(new, to)
            full = f"{where}/{entry.name}"
            if record.attributes & ATTR_READ_ONLY:
                raise CardError.of("card.read-only", full, value="it is marked as read-only")
            self._files.check_move(full, f"{there}/{new}", is_directory=entry.is_directory)
            if first == target:
                taken = {other.entry.short_name for other in slots.records if other != record}
                renamed = replace(entry, name=new, short_name=names.short_name(new, taken))
                with self._changing():
                    data = build(renamed, record.attributes, record.cluster)
                    if self._directories.replace(slots, record, data):
                        return True
            if entry.is_directory:
                raise CardError.of("card.no-slots", full, value=new)
            return False

    def remove_directory(self, path: str) -> None:
        """Like `Card.remove_directory`: deletes the entry first, then frees the clusters."""
        with self._file(path) as (first, where, name):
            slots, record = self._existing(first, where, name)
            full = f"{where}/{record.entry.name}"
            if not record.entry.is_directory:
                raise CardError.of("card.not-directory", full)
            self._files.check_below(full)
            if kept := self._directories.load(record.cluster).first_name:
                raise CardError.of("card.not-empty", full, value=kept)
            with self._changing():
                self._directories.delete(slots, record)
                self._volume.table.release(record.cluster)

    @property
    def free_bytes(self) -> int:
        """The size of all free clusters, in bytes."""
        with self._lock:
            return self._volume.table.free * self._volume.layout.cluster_bytes

    def close(self) -> None:
        """Like `Card.close`: discards files that are being written, and releases the device."""
        with self._lock:
            for writer in list(self._writers):
                writer.give_up(
                    CardError.of("card.removed", self._device.path, value="it was unmounted")
                )
            self._device.close()

    def _store(self, first: int, where: str, name: str, cluster: int, size: int) -> None:
        """Enters a finished chain into the directory: in a new record, or in that of the file that
        it replaces."""
        slots = self._directories.load(first)
        found = self._lookup(slots, name)
        if not found:
            entry = self._new_entry(slots, name, is_directory=False, size=size)
            self._directories.insert(slots, build(entry, ATTR_ARCHIVE, cluster))
            return
        full = f"{where}/{found.entry.name}"
        self._check_replaceable(found, full)
        if found.entry.name != name:  # since `create`, another file has got this 8.3 name
            self._files.check(full)
        if found.cluster:
            self._volume.table.check(found.cluster)
        self._directories.rewrite(slots, found, size, cluster, self._now())
        if found.cluster:
            self._volume.table.release(found.cluster)

    def _new_entry(self, slots: Slots, name: str, *, is_directory: bool, size: int) -> Entry:
        taken = {record.entry.short_name for record in slots.records}
        return Entry(name, names.short_name(name, taken), is_directory, size, self._now())

    @staticmethod
    def _check_replaceable(record: Record, full: str) -> None:
        if record.entry.is_directory:
            raise CardError.of("card.directory", full)
        if record.attributes & ATTR_READ_ONLY:
            raise CardError.of("card.read-only", full, value="the file is marked as read-only")

    @staticmethod
    def _lookup(slots: Slots, name: str) -> Record | None:
        return lookup(slots.records, name, lambda record: record.entry)

    def _existing(self, first: int, where: str, name: str) -> tuple[Slots, Record]:
        slots = self._directories.load(first)
        found = self._lookup(slots, name)
        if found is None:
            raise CardError.of("card.not-found", f"{where}/{name}")
        return slots, found

    def _directory(self, parts: list[str]) -> tuple[int, str]:
        """The first cluster of a directory, and its path in the card's own spelling."""
        first, where = self._volume.layout.root, ""
        seen = {first}
        for part in parts:
            record = self._existing(first, where, part)[1]
            where = f"{where}/{record.entry.name}"
            if not record.entry.is_directory:
                raise CardError.of("card.not-directory", where)
            first = record.cluster
            if first in seen:
                raise CardError.of(
                    "card.broken", where, key="a directory", value="inside itself", limit="a tree"
                )
            seen.add(first)
        return first, where

    @contextmanager
    def _file(self, path: str) -> Generator[tuple[int, str, str]]:
        """The directory, its path, and the file's name as the caller wrote it. Call it with the
        lock held."""
        parts = names.split(path)
        if not parts:
            raise CardError.of("card.directory", "/")
        with self._lock:
            yield *self._directory(parts[:-1]), parts[-1]

    @contextmanager
    def _changing(self) -> Generator[None]:
        self._volume.begin()
        try:
            yield
        finally:
            self._volume.end()
