"""The cache of facts about files, in the state folder of the printer."""

from __future__ import annotations

import logging
import sqlite3
import threading
import weakref
from contextlib import closing
from pathlib import Path

from passo.card import Entry
from passo.card.names import fold

_log = logging.getLogger(__name__)
_MOST = 5000  # files
_TABLE = """
CREATE TABLE IF NOT EXISTS known (
  path TEXT PRIMARY KEY, size INTEGER, modified TEXT, made_for TEXT, data BLOB
) STRICT
"""


class MetadataCache:
    """Stores bytes for each file, which are valid while the file and the machine stay the same. Any
    thread may use it. A cache that cannot be read behaves as an empty one. The file is closed when
    the cache is no longer used."""

    def __init__(self, folder: Path | None, made_for: str) -> None:
        """`made_for` identifies the machine and the version. Without a folder, the cache is in
        memory."""
        self._made_for = made_for
        self._lock = threading.Lock()
        try:
            self._base = _opened(":memory:" if folder is None else folder / "files.sqlite")
        except (sqlite3.Error, OSError) as error:
            _log.warning("Facts about files are not kept: %s", error)
            self._base = _opened(":memory:")
        weakref.finalize(self, self._base.close)

    def get(self, path: str, entry: Entry) -> bytes | None:
        """The facts about this content of a file."""
        key = (fold(path), entry.size, entry.modified.isoformat(), self._made_for)
        words = "SELECT data FROM known WHERE (path, size, modified, made_for) = (?, ?, ?, ?)"
        with self._lock:
            try:
                found = self._base.execute(words, key).fetchone()
            except sqlite3.Error as error:
                _log.warning("Facts about files cannot be read: %s", error)
                return None
        return found and found[0]

    def put(self, path: str, entry: Entry, data: bytes) -> None:
        """Stores the facts about this content of a file."""
        row = (fold(path), entry.size, entry.modified.isoformat(), self._made_for, data)
        old = "DELETE FROM known WHERE rowid <= (SELECT MAX(rowid) FROM known) - ?"
        with self._lock:
            try:
                with self._base:
                    self._base.execute("REPLACE INTO known VALUES (?, ?, ?, ?, ?)", row)
                    self._base.execute(old, (_MOST,))
            except sqlite3.Error as error:
                _log.warning("Facts about files are not kept: %s", error)


def _opened(path: str | Path) -> sqlite3.Connection:
    base = sqlite3.connect(path, check_same_thread=False, timeout=1.0)
    try:
        with closing(base.cursor()) as cursor:
            cursor.execute("PRAGMA journal_mode = WAL")
            cursor.execute("PRAGMA synchronous = NORMAL")
            cursor.execute(_TABLE)
    except sqlite3.Error:
        base.close()
        raise
    return base
