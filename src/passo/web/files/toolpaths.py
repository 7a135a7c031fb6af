"""The toolpaths of planned files, stored on disk."""

from __future__ import annotations

import hashlib
import logging
import shutil
import weakref
from contextlib import suppress
from pathlib import Path
from tempfile import mkdtemp

from passo.card import Entry
from passo.card.names import fold
from passo.job.durable_files import replaced

_log = logging.getLogger(__name__)
_MAX_BYTES = 512 << 20  # of all files together
_ENDING = ".toolpath"


class Toolpaths:
    """Stores one file for each toolpath, valid while the G-code file and the machine stay the same.
    If all of them are too large together, the oldest are deleted. Any thread may use it."""

    def __init__(self, folder: Path | None, made_for: str) -> None:
        """`made_for` identifies the machine and the version. Without a folder, the toolpaths are
        deleted at the end of the process."""
        self._made_for = made_for
        if folder is None:
            self._folder = Path(mkdtemp(prefix="passo-"))
            weakref.finalize(self, shutil.rmtree, self._folder, ignore_errors=True)
        else:
            self._folder = folder / "toolpaths"

    def find(self, path: str, entry: Entry) -> Path | None:
        """The toolpath of this content of a file; None if it is not stored."""
        found = self._place(path, entry)
        return found if found.exists() else None

    def put(self, path: str, entry: Entry, data: bytes) -> None:
        """Stores the toolpath of this content of a file, if there is space."""
        try:
            self._folder.mkdir(parents=True, exist_ok=True)
            with replaced(self._place(path, entry)) as temporary:
                temporary.write_bytes(data)
            self._make_room()
        except OSError as error:
            _log.warning("The path of %s is not kept: %s", path, error)

    def _place(self, path: str, entry: Entry) -> Path:
        words = (fold(path), str(entry.size), entry.modified.isoformat(), self._made_for)
        digest = hashlib.blake2b("\0".join(words).encode(), digest_size=16)
        return self._folder / f"{digest.hexdigest()}{_ENDING}"

    def _make_room(self) -> None:
        files = self._folder.glob(f"*{_ENDING}")
        kept = sorted((p.stat().st_mtime, p.stat().st_size, p) for p in files)
        total = sum(size for _, size, _ in kept)
        for _, size, place in kept[:-1]:
            if total <= _MAX_BYTES:
                return
            with suppress(OSError):
                place.unlink()
            total -= size
