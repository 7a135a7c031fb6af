"""What was printed, one row a print, and how long the printer was on, one row a run; in SQLite."""

from __future__ import annotations

import sqlite3
from dataclasses import dataclass
from pathlib import Path

_SCHEMA = """
create table if not exists prints (
    id integer primary key,
    file text not null,
    size integer not null,
    ended text not null,      -- done, cancelled, failed; interrupted, also while it goes on
    print_s real not null,
    filament_mm real not null,
    note text not null default ''  -- what went not so well
)
"""
_RUNS = "create table if not exists runs (id integer primary key, on_s real not null)"
_NOTE = "alter table prints add column note text not null default ''"  # older bases lack it


_TIMEOUT_S = 0.1  # with another one who writes: the printer waits meanwhile


@dataclass(frozen=True, slots=True)
class Totals:
    """Of all prints that are remembered."""

    prints: int
    done: int
    print_s: float
    longest_s: float
    filament_mm: float
    on_s: float  # that the printer was on, printing or not


class History:
    """The prints of one printer. Raises sqlite3.Error."""

    def __init__(self, directory: Path) -> None:
        directory.mkdir(parents=True, exist_ok=True)
        self._run: int | None = None  # row of this one
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
            if not self._base.execute(
                "select 1 from pragma_table_info('prints') where name = 'note'"
            ).fetchone():
                self._base.execute(_NOTE)

    def add(
        self,
        file: str,
        size: int,
        ended: str,
        print_s: float,
        filament_mm: float,
        note: str = "",
        row: int | None = None,
    ) -> int | None:
        """A print, in place of that `row` if it is still there; returns the row. Durable when it
        returns."""
        with self._base:
            return self._base.execute(
                "insert or replace into prints (id, file, size, ended, print_s, filament_mm, note)"
                " values (?, ?, ?, ?, ?, ?, ?)",
                (row, file, size, ended, print_s, filament_mm, note),
            ).lastrowid

    def was_on(self, seconds: float) -> None:
        """So long this run has lasted by now. Durable when it returns."""
        with self._base:
            if self._run is None:
                found = self._base.execute("insert into runs (on_s) values (?)", (seconds,))
                self._run = found.lastrowid
            else:
                self._base.execute("update runs set on_s = ? where id = ?", (seconds, self._run))

    def totals(self, but: int | None = None) -> Totals:
        """What M78 tells, `but` for the print of that row, which goes on."""
        row = self._base.execute(
            "select count(*), coalesce(sum(ended = 'done'), 0), coalesce(sum(print_s), 0),"
            " coalesce(max(print_s), 0), coalesce(sum(filament_mm), 0),"
            " (select coalesce(sum(on_s), 0) from runs) from prints where id is not ?",
            (but,),
        ).fetchone()
        return Totals(*row)

    def last(self, most: int, but: int | None = None) -> list[tuple[str, str, float, str]]:
        """The newest prints, `but` for that row: file, how it ended, print time in seconds, what
        went not so well."""
        return self._base.execute(
            "select file, ended, print_s, note from prints where id is not ?"
            " order by id desc limit ?",
            (but, most),
        ).fetchall()

    def forget(self) -> None:
        """All rows go."""
        with self._base:
            self._base.execute("delete from prints")
            self._base.execute("delete from runs")
        self._run = None

    def close(self) -> None:
        """Nothing may be asked any more."""
        self._base.close()
