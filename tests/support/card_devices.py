"""Block devices, which not every computer lets a test make: images that look like one."""

import errno
import os
import stat
from collections.abc import Callable
from pathlib import Path

import pytest


class BlockDevice:
    """An image as Linux shows a block device: `stat` tells no size, and one program at a time, or
    what is mounted, has it with O_EXCL. `opened` are the flags of each `os.open` that succeeded;
    `refuses` tells which do not, by an error number for their flags (0: none)."""

    def __init__(self, path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        self.path = path
        self.opened: list[int] = []
        self.refuses: Callable[[int], int] = lambda _: 0
        self._holders: list[int] = []
        self._inode = os.lstat(path).st_ino
        real_stat, real_open = os.stat, os.open

        def shown(name: str | Path | int, **keywords: object) -> os.stat_result:
            found = real_stat(name, **keywords)  # pyright: ignore[reportArgumentType, reportCallIssue]
            if name not in (path, str(path)):
                return found
            fields = list(found)
            fields[stat.ST_MODE] = stat.S_IFBLK | 0o660
            fields[stat.ST_SIZE] = 0
            return os.stat_result(fields)

        def opened(name: str | Path, flags: int, *rest: int, **keywords: int) -> int:
            if name not in (path, str(path)):
                return real_open(name, flags, *rest, **keywords)
            error = self.refuses(flags)
            if not error and flags & os.O_EXCL and any(self._open(fd) for fd in self._holders):
                error = errno.EBUSY
            if error:
                raise OSError(error, os.strerror(error), str(name))
            descriptor = real_open(name, flags & ~os.O_EXCL, *rest, **keywords)
            self.opened.append(flags)
            if flags & os.O_EXCL:
                self._holders.append(descriptor)
            return descriptor

        monkeypatch.setattr(os, "stat", shown)
        monkeypatch.setattr(os, "open", opened)

    def _open(self, descriptor: int) -> bool:
        """This holder has not been closed."""
        try:
            return os.fstat(descriptor).st_ino == self._inode
        except OSError:
            return False
