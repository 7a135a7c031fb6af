"""A folder of the host as a card.

Nothing outside the folder can be reached: each directory is opened relative to its parent, and
symbolic links are not followed. Links, devices and pipes do not appear on the card.
"""

from __future__ import annotations

import errno
import hashlib
import os
import stat
import threading
from collections.abc import Callable, Generator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

from passo.card import names
from passo.card.api import Card, Entry, Reader, Writer
from passo.card.tree import OpenFiles, lookup
from passo.errors import CardError

_PARTIAL = ".passo-part-"
"""Prefix of the name under which a file is written. The rest depends only on the final name, so
that the next attempt overwrites the remains of a power cut. Such files do not appear on the
card."""

_NAME_MAX = 255
_LATEST = 0xFFFFFFFF
"""The latest time of change that is reported, in s since 1970; it is in the year 2106."""

_DIRECTORY = os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW | os.O_CLOEXEC
_FILE = os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC
_NEW = os.O_WRONLY | os.O_CREAT | os.O_TRUNC | os.O_NOFOLLOW | os.O_CLOEXEC


def _host_failure(error: OSError, path: str, needed: int = 0) -> CardError:
    """Converts an error of the host's file system to a card error."""
    value = error.strerror or str(error)
    if error.errno in (errno.ENOSPC, errno.EDQUOT, errno.EFBIG):
        return CardError.of("card.full", path, value=needed or "more", limit="none")
    if error.errno in (errno.EACCES, errno.EPERM, errno.EROFS):
        return CardError.of("card.read-only", path, value=value)
    if error.errno == errno.ENAMETOOLONG:
        return CardError.of(
            "card.name", path, value=path.rpartition("/")[2], limit="a shorter name"
        )
    if error.errno == errno.EEXIST:  # a link or device, which is not on the card
        return CardError.of("card.exists", path)
    if error.errno in (errno.ENOENT, errno.ENOTDIR, errno.ELOOP):
        return CardError.of("card.not-found", path)
    return CardError.of("card.removed", path, value=value)


def _check_name(name: str, path: str) -> None:
    names.check(name, path)
    limit = ""
    if len(os.fsencode(name)) > _NAME_MAX:
        limit = f"at most {_NAME_MAX} bytes in a folder of the host"
    elif name.startswith(_PARTIAL):
        limit = f"a name that does not begin with {_PARTIAL}"
    if limit:
        raise CardError.of("card.name", path, value=name, limit=limit)


@dataclass(frozen=True, slots=True)
class _Place:
    """An open directory of a card, its path there, and the check that the card is still mounted."""

    folder: int
    path: str
    check_mounted: Callable[[str], object]


class FolderCard(Card):
    """The files below a folder; 8.3 names are made up from the long ones and stay the same."""

    def __init__(self, path: str | Path) -> None:
        """Raises CardError `card.absent` if `path` is not a readable folder."""
        self._path = str(path)
        self._lock = threading.RLock()
        self._files = OpenFiles()
        self._writers: set[_FolderWriter] = set()
        try:
            self._root: int | None = os.open(path, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
        except OSError as error:
            raise CardError.of("card.absent", self._path, value=error.strerror) from error

    def list(self, directory: str = "/") -> list[Entry]:
        """Like `Card.list`."""
        with self._directory(names.split(directory)) as (folder, _):
            return self._entries(folder)

    def find(self, path: str) -> Entry:
        """Like `Card.find`; the root has no name."""
        parts = names.split(path)
        if not parts:
            return Entry("", "", True, 0, datetime(1980, 1, 1))
        with self._directory(parts[:-1]) as (folder, where):
            return self._existing(folder, where, parts[-1])

    def open(self, path: str) -> Reader:
        """Like `Card.open`: the reader returns the content that the file has now. It raises
        CardError `card.changed` if the file is rewritten in place. If another file takes its name,
        a reader that has begun reads on to the end of the old file, and one at offset 0 raises
        `card.changed`."""
        with self._file(path) as (folder, where, name):
            entry = self._existing(folder, where, name)
            full = f"{where}/{entry.name}"
            if entry.is_directory:
                raise CardError.of("card.directory", full)
            self._files.begin_read(full)
            try:
                file = os.open(entry.name, _FILE, dir_fd=folder)
            except OSError:
                self._files.end_read(full)
                raise
            opened = os.fstat(file)

        def check_unchanged(offset: int) -> None:
            now = os.fstat(file)
            if now.st_size != opened.st_size:
                value = f"it has {now.st_size} bytes instead of {opened.st_size}"
            elif now.st_mtime_ns != opened.st_mtime_ns:
                value = "it was written to"
            elif not (now.st_nlink or offset):
                value = "it was replaced or removed"
            else:
                return
            raise CardError.of("card.changed", full, value=value)

        def fetch(offset: int, into: memoryview) -> None:
            done = 0
            while done < len(into):
                self._opened(full)
                try:
                    count = os.preadv(file, [into[done:]], offset + done)
                except OSError as error:
                    raise CardError.of("card.removed", full, value=error.strerror) from error
                # check after the read: then the data is older than any change
                check_unchanged(offset)
                if not count:
                    raise CardError.of(
                        "card.removed", full, value=f"it ends at {offset + done} bytes"
                    )
                done += count

        def released() -> None:
            os.close(file)
            with self._lock:
                self._files.end_read(full)

        return Reader(opened.st_size, fetch, released)

    def create(self, path: str) -> Writer:
        """Like `Card.create`: a file that is replaced stays until the new one is whole."""
        with self._file(path) as (folder, where, name):
            found = lookup(self._entries(folder), name, lambda entry: entry)
            if found and found.is_directory:
                raise CardError.of("card.directory", f"{where}/{found.name}")
            if not found:
                _check_name(name, path)
            place = _Place(os.dup(folder), where, self._opened)
            full = f"{where}/{found.name if found else name}"

            def released() -> None:
                self._files.end_write(full)
                self._writers.discard(writer)

            try:
                self._files.begin_write(full)
                try:
                    writer = _FolderWriter(place, full.rpartition("/")[2], released)
                except BaseException:
                    self._files.end_write(full)
                    raise
            except BaseException:
                os.close(place.folder)
                raise
            self._writers.add(writer)
            return writer

    def remove(self, path: str) -> None:
        """Like `Card.remove`."""
        with self._file(path) as (folder, where, name):
            entry = self._existing(folder, where, name)
            if entry.is_directory:
                raise CardError.of("card.directory", f"{where}/{entry.name}")
            self._files.check(f"{where}/{entry.name}")
            os.unlink(entry.name, dir_fd=folder)
            os.fsync(folder)

    def make_directory(self, path: str) -> None:
        """Like `Card.make_directory`."""
        with self._file(path) as (folder, where, name):
            found = lookup(self._entries(folder), name, lambda entry: entry)
            if found:
                raise CardError.of("card.exists", f"{where}/{found.name}")
            _check_name(name, path)
            os.mkdir(name, dir_fd=folder)
            os.fsync(folder)

    def rename(self, path: str, to: str) -> None:
        """Like `Card.rename`."""
        with self._file(path) as (folder, where, name), self._file(to) as (target, there, new):
            entry = self._existing(folder, where, name)
            old_path, new_path = f"{where}/{entry.name}", f"{there}/{new}"
            found = lookup(self._entries(target), new, lambda entry: entry)
            if found and (where, entry.name) != (there, found.name):
                raise CardError.of("card.exists", f"{there}/{found.name}")
            _check_name(new, to)
            self._files.check_move(old_path, new_path, is_directory=entry.is_directory)
            os.rename(entry.name, new, src_dir_fd=folder, dst_dir_fd=target)
            os.fsync(target)
            os.fsync(folder)

    def remove_directory(self, path: str) -> None:
        """Like `Card.remove_directory`; also deletes the remains of interrupted uploads."""
        with self._file(path) as (folder, where, name):
            entry = self._existing(folder, where, name)
            full = f"{where}/{entry.name}"
            if not entry.is_directory:
                raise CardError.of("card.not-directory", full)
            self._files.check_below(full)
            inner = os.open(entry.name, _DIRECTORY, dir_fd=folder)
            try:
                with os.scandir(inner) as items:
                    inside = [item.name for item in items]
                if kept := next((name for name in inside if not name.startswith(_PARTIAL)), None):
                    raise CardError.of("card.not-empty", full, value=kept)
                for name in inside:
                    os.unlink(name, dir_fd=inner)
            finally:
                os.close(inner)
            os.rmdir(entry.name, dir_fd=folder)
            os.fsync(folder)

    @property
    def free_bytes(self) -> int:
        """The free space of the file system for users without privileges, in bytes."""
        with self._directory([]) as (folder, _):
            room = os.fstatvfs(folder)
            return room.f_bavail * room.f_frsize

    def close(self) -> None:
        """Like `Card.close`: discards files that are being written, and releases the folder."""
        with self._lock:
            if self._root is not None:
                os.close(self._root)
                self._root = None
            writers = list(self._writers)
        for writer in writers:
            writer.give_up(CardError.of("card.removed", self._path, value="it was unmounted"))

    def _opened(self, path: str) -> int:
        if self._root is None:
            raise CardError.of("card.removed", path, value="it was unmounted")
        return self._root

    @contextmanager
    def _directory(self, parts: list[str]) -> Generator[tuple[int, str]]:
        """A descriptor of the directory, and its path in the spelling of the card."""
        path = "/" + "/".join(parts)
        with self._lock:
            folder, where = os.dup(self._opened(path)), ""
            try:
                for part in parts:
                    entry = self._existing(folder, where, part)
                    where = f"{where}/{entry.name}"
                    if not entry.is_directory:
                        raise CardError.of("card.not-directory", where)
                    inner = os.open(entry.name, _DIRECTORY, dir_fd=folder)
                    os.close(folder)
                    folder = inner
                yield folder, where
            except OSError as error:
                raise _host_failure(error, path) from error
            finally:
                os.close(folder)

    @contextmanager
    def _file(self, path: str) -> Generator[tuple[int, str, str]]:
        """The descriptor and path of a file's directory, and the file's name as the caller wrote
        it."""
        parts = names.split(path)
        if not parts:
            raise CardError.of("card.directory", "/")
        with self._directory(parts[:-1]) as (folder, where):
            yield folder, where, parts[-1]

    def _existing(self, folder: int, where: str, name: str) -> Entry:
        found = lookup(self._entries(folder), name, lambda entry: entry)
        if found is None:
            raise CardError.of("card.not-found", f"{where}/{name}")
        return found

    @staticmethod
    def _entries(folder: int) -> list[Entry]:
        seen: list[tuple[str, os.stat_result]] = []
        with os.scandir(folder) as items:
            for item in items:
                if names.is_presentable(item.name) and not item.name.startswith(_PARTIAL):
                    with suppress(FileNotFoundError):
                        status = item.stat(follow_symlinks=False)
                        if stat.S_ISREG(status.st_mode) or stat.S_ISDIR(status.st_mode):
                            seen.append((item.name, status))
        taken: set[str] = set()
        entries: list[Entry] = []
        for name, status in sorted(seen, key=lambda pair: (names.fold(pair[0]), pair[0])):
            short = names.stable_short_name(name, taken)
            taken.add(short)
            directory = stat.S_ISDIR(status.st_mode)
            modified = datetime.fromtimestamp(min(max(int(status.st_mtime), 0), _LATEST))
            entries.append(
                Entry(name, short, directory, 0 if directory else status.st_size, modified)
            )
        return entries


class _FolderWriter(Writer):
    """Writes to a temporary file, which `close` renames to the file's name."""

    def __init__(self, place: _Place, name: str, released: Callable[[], None]) -> None:
        """`released()` is called once, when the writer has ended."""
        super().__init__()
        self._place, self._name = place, name
        self._full = f"{place.path}/{name}"
        digest = hashlib.blake2b(names.fold(name).encode(), digest_size=12).hexdigest()
        self._partial = _PARTIAL + digest
        self._released = released
        # not the card's lock, so that a slow medium does not delay other calls
        self._lock = threading.Lock()
        self._file = os.open(self._partial, _NEW, mode=0o666, dir_fd=place.folder)

    def give_up(self, error: CardError) -> None:
        """Ends the writer because the card is unmounted; later calls raise `error`."""
        self.abort()
        self._failure = self._failure or error

    def _append(self, data: bytes) -> None:
        left = memoryview(data)
        with self._lock:
            self._place.check_mounted(self._full)
            try:
                while left:
                    left = left[os.write(self._file, left) :]
            except OSError as error:
                raise _host_failure(error, self._full, needed=len(left)) from error

    def _store(self) -> None:
        folder = self._place.folder
        with self._lock:
            self._place.check_mounted(self._full)
            try:
                os.fsync(self._file)
                os.replace(self._partial, self._name, src_dir_fd=folder, dst_dir_fd=folder)
                os.fsync(folder)
            except FileNotFoundError:  # its directory was deleted, with the data
                value = "its folder was removed"
                raise CardError.of("card.removed", self._full, value=value) from None
            except OSError as error:
                raise _host_failure(error, self._full) from error
            self._release()

    def _discard(self) -> None:
        with self._lock:
            with suppress(OSError):
                os.unlink(self._partial, dir_fd=self._place.folder)
            self._release()

    def _release(self) -> None:
        os.close(self._file)
        os.close(self._place.folder)
        self._released()
