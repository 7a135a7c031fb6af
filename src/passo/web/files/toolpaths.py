"""The paths of planned files, kept on disk with the facts about them."""

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
    """A file for each path, as long as its G-code file and the machine stay the same. When they are
    too large together, the oldest are deleted. Any thread may use it."""

    def __init__(self, folder: Path | None, made_for: str) -> None:
        """`made_for` is the machine and version; without a folder all ends with the process."""
        self._made_for = made_for
        if folder is None:
            self._folder = Path(mkdtemp(prefix="passo-"))
            weakref.finalize(self, shutil.rmtree, self._folder, ignore_errors=True)
        else:
            self._folder = folder / "toolpaths"

    def find(self, path: str, entry: Entry) -> Path | None:
        """The path of this content of a file."""
        found = self._place(path, entry)
        return found if found.exists() else None

    def put(self, path: str, entry: Entry, data: bytes) -> None:
        """Stores the path of this content of a file; without space it is not kept."""
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
