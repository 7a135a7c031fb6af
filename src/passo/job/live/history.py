"""The history in SQLite: one row for each print, and one row for each run of the program."""

from __future__ import annotations

import sqlite3
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

_SCHEMA = """
create table if not exists prints (
    id integer primary key,
    file text not null,
    size integer not null,
    ended text not null,      -- done, cancelled, failed; interrupted, also while it goes on
    print_s real not null,
    filament_mm real not null,
    note text not null default '',  -- what went not so well
    started_s real,  -- the wall clock, in seconds since 1970
    run text not null default ''  -- the run id of its start
)
"""
_RUNS = "create table if not exists runs (id integer primary key, on_s real not null)"
_LATER = {  # columns that older databases do not have
    "note": "alter table prints add column note text not null default ''",
    "started_s": "alter table prints add column started_s real",
    "run": "alter table prints add column run text not null default ''",
}


_TIMEOUT_S = 0.1  # maximum wait for another process that writes; the printer waits too


@dataclass(frozen=True, slots=True)
class Totals:
    """The totals of all stored prints."""

    prints: int
    done: int
    print_s: float
    longest_s: float
    filament_mm: float
    on_s: float  # time for which the printer was on, printing or idle


class PrintRow(NamedTuple):
    """A finished print; `number` is that of its row; `started_s` is wall clock time in seconds
    since 1970, None if unknown; `run` is the run id of its start, or empty."""

    file: str
    size: int
    started_s: float | None
    ended: str
    print_s: float
    filament_mm: float
    note: str
    run: str
    number: int


class History:
    """The prints of one printer. Raises sqlite3.Error."""

    def __init__(self, directory: Path, wall_s: Callable[[], float] = time.time) -> None:
        """`wall_s` is the wall clock, in seconds since 1970."""
        self._wall_s = wall_s
        directory.mkdir(parents=True, exist_ok=True)
        self._run: int | None = None  # the row of this run
        self._base = sqlite3.connect(directory / "history.sqlite", timeout=_TIMEOUT_S)
        try:
            self._prepare()
        except sqlite3.Error:
            self.close()
            raise

    def _prepare(self) -> None:
        self._base.execute("pragma journal_mode = wal")
        with self._base:
            self._base.execute(_SCHEMA)
            self._base.execute(_RUNS)
            query = "select 1 from pragma_table_info('prints') where name = ?"
            for name, addition in _LATER.items():
                if not self._base.execute(query, (name,)).fetchone():
                    self._base.execute(addition)

    def add(
        self,
        file: str,
        size: int,
        ended: str,
        print_s: float,
        filament_mm: float,
        note: str = "",
        row: int | None = None,
        run: str = "",
    ) -> int | None:
        """Adds a print, or updates the print with the number `row` if it still exists. Returns the
        number of the row. When this returns, the row survives a power cut."""
        with self._base:
            return self._base.execute(
                "insert or replace into prints"
                " (id, file, size, ended, print_s, filament_mm, note, run, started_s)"
                " values (?, ?, ?, ?, ?, ?, ?, ?,"
                " coalesce((select started_s from prints where id = ?), ?))",
                (row, file, size, ended, print_s, filament_mm, note, run, row, self._wall_s()),
            ).lastrowid

    def was_on(self, seconds: float) -> None:
        """Stores the duration of this run. Durable when it returns."""
        with self._base:
            if self._run is None:
                found = self._base.execute("insert into runs (on_s) values (?)", (seconds,))
                self._run = found.lastrowid
            else:
                self._base.execute("update runs set on_s = ? where id = ?", (seconds, self._run))

    def totals(self, but: int | None = None) -> Totals:
        """The totals for M78, without the print of row `but`, which is still running."""
        row = self._base.execute(
            "select count(*), coalesce(sum(ended = 'done'), 0), coalesce(sum(print_s), 0),"
            " coalesce(max(print_s), 0), coalesce(sum(filament_mm), 0),"
            " (select coalesce(sum(on_s), 0) from runs) from prints where id is not ?",
            (but,),
        ).fetchone()
        return Totals(*row)

    def last(self, most: int, but: int | None = None) -> list[PrintRow]:
        """The newest prints, without row `but`."""
        rows = self._base.execute(
            "select file, size, started_s, ended, print_s, filament_mm, note, run, id from prints"
            " where id is not ? order by id desc limit ?",
            (but, most),
        )
        return [PrintRow(*row) for row in rows]

    def forget(self) -> None:
        """Deletes all rows."""
        with self._base:
            self._base.execute("delete from prints")
            self._base.execute("delete from runs")
        self._run = None

    def close(self) -> None:
        """Closes the database; no method may be called after that."""
        self._base.close()
