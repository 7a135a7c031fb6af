"""Results that several studies share, by the id of the case."""

from __future__ import annotations

import json
import sqlite3
from collections.abc import Iterable, Mapping
from contextlib import closing
from pathlib import Path
from typing import TYPE_CHECKING

from passo.errors import InputError

if TYPE_CHECKING:
    from passo.study.work import Result

_KEPT = frozenset({"ok", "input"})  # the others depend on the computer
_MANY = 500  # ids in one question


class Cache:
    """A file of SQLite. Several studies may use it at the same time. Raises InputError if the file
    is not such a cache, or cannot be written."""

    def __init__(self, path: Path) -> None:
        self._path = path
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            with closing(self._connect()) as database, database:
                database.execute("PRAGMA journal_mode=WAL")
                database.execute(
                    "CREATE TABLE IF NOT EXISTS results (id TEXT PRIMARY KEY, result TEXT NOT NULL)"
                )
        except (OSError, sqlite3.Error) as error:
            raise self._failed(error) from None

    def found(self, ids: Iterable[str]) -> dict[str, Result]:
        """The results of those ids that it has."""
        wanted, results = list(ids), dict[str, "Result"]()
        try:
            with closing(self._connect()) as database:
                for i in range(0, len(wanted), _MANY):
                    some = wanted[i : i + _MANY]
                    marks = ",".join("?" * len(some))
                    question = f"SELECT id, result FROM results WHERE id IN ({marks})"
                    rows = database.execute(question, some)
                    results |= {id_: json.loads(text) for id_, text in rows}
        except (sqlite3.Error, ValueError) as error:
            raise self._failed(error) from None
        return results

    def add(self, results: Mapping[str, Result]) -> None:
        """Keeps those results that do not depend on the computer."""
        rows = [
            (id_, json.dumps(result))
            for id_, result in results.items()
            if result["status"] in _KEPT
        ]
        try:
            with closing(self._connect()) as database, database:
                database.executemany("INSERT OR IGNORE INTO results VALUES (?, ?)", rows)
        except sqlite3.Error as error:
            raise self._failed(error) from None

    def _connect(self) -> sqlite3.Connection:
        return sqlite3.connect(self._path, timeout=60)

    def _failed(self, error: Exception) -> InputError:
        return InputError.of("study.cache", str(self._path), value=str(error))
