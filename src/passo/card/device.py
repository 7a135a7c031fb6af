"""The bytes under a file system: an image file or a block device, locked against other programs."""

from __future__ import annotations

import errno
import fcntl
import os
import stat
from pathlib import Path

from passo.errors import CardError

_PROTECTED = (errno.EACCES, errno.EPERM, errno.EROFS)


class Device:
    """Reads and writes complete byte ranges; any failure is CardError `card.removed`."""

    def __init__(self, path: str | Path) -> None:
        """Raises `card.absent`, or `card.busy` if it is mounted or another process uses it as a
        card.

        `read_only` is true if writing is not permitted.
        """
        self.path = str(path)
        self.read_only = False
        try:
            # On a block device, O_EXCL fails while the device is mounted or open with O_EXCL
            # elsewhere.
            mode = Path(path).stat().st_mode
            if not (stat.S_ISBLK(mode) or stat.S_ISREG(mode)):
                raise CardError.of(
                    "card.absent", self.path, value="neither folder, image nor device"
                )
            exclusive = os.O_EXCL if stat.S_ISBLK(mode) else 0
            flags = os.O_CLOEXEC | exclusive
            try:
                self._file: int | None = os.open(path, os.O_RDWR | flags)
            except OSError as error:
                if error.errno not in _PROTECTED:
                    raise
                self._file = os.open(path, os.O_RDONLY | flags)
                self.read_only = True
        except OSError as error:
            if error.errno == errno.EBUSY:
                why = "it is mounted, or another program has it"
                raise CardError.of("card.busy", self.path, value=why) from error
            raise CardError.of("card.absent", self.path, value=error.strerror) from error
        try:
            sharing = fcntl.LOCK_SH if self.read_only else fcntl.LOCK_EX
            fcntl.flock(self._file, sharing | fcntl.LOCK_NB)
            self.size = os.lseek(self._file, 0, os.SEEK_END)
        except OSError as error:
            os.close(self._file)
            raise CardError.of("card.busy", self.path, value="another program has it") from error

    def read(self, offset: int, count: int) -> bytearray:
        """`count` bytes from `offset`, all of them. Raises CardError."""
        data = bytearray(count)
        self.read_into(offset, memoryview(data))
        return data

    def read_into(self, offset: int, into: memoryview) -> None:
        """Fills `into` with the bytes from `offset`. Raises CardError."""
        done = 0
        while done < len(into):
            try:
                count = os.preadv(self._opened(), [into[done:]], offset + done)
            except OSError as error:
                raise CardError.of("card.removed", self.path, value=error.strerror) from error
            if not count:
                raise CardError.of(
                    "card.removed", self.path, value=f"it ends at {offset + done} bytes"
                )
            done += count

    def write(self, offset: int, data: bytes | bytearray | memoryview) -> None:
        """Writes all of `data`; after `flush` it survives a power cut. Raises CardError:
        `card.read-only` if the device can be read but not written."""
        left = memoryview(data)
        try:
            while left:
                count = os.pwrite(self._opened(), left, offset)
                offset += count
                left = left[count:]
        except OSError as error:
            if error.errno in _PROTECTED:
                raise CardError.of(
                    "card.read-only", self.path, value="it is write-protected"
                ) from error
            raise CardError.of("card.removed", self.path, value=error.strerror) from error

    def flush(self) -> None:
        """A barrier: all earlier writes reach the medium before any later write. Raises CardError,
        also if the image was deleted in the meantime."""
        try:
            os.fdatasync(self._opened())
            if not os.fstat(self._opened()).st_nlink:
                raise CardError.of("card.removed", self.path, value="it was deleted")
        except OSError as error:
            raise CardError.of("card.removed", self.path, value=error.strerror) from error

    def close(self) -> None:
        """Releases the medium; closing twice is allowed."""
        if self._file is not None:
            os.close(self._file)
            self._file = None

    def _opened(self) -> int:
        if self._file is None:
            raise CardError.of("card.removed", self.path, value="it was unmounted")
        return self._file
