"""What the hub keeps, in SQLite: each change is one transaction, and durable when it returns.

Open jobs with all their runs, printers, files and groups are also in memory, for the decisions of
the farm; the history is only in the file. One thread uses it.
"""

from __future__ import annotations

import os
import sqlite3
from collections.abc import Callable, Generator, Mapping, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from time import time
from typing import Any, Final, TypeVar, cast

from msgspec import Struct
from msgspec.structs import replace

from passo.errors import HubError
from passo.hub.records import GroupRow, JobRow, PrinterRow, RunRow, ServiceRow, SettingRow
from passo.hub.rows import Table, cell
from passo.hub.run_state import TRANSITIONS, RunState
from passo.hub.schema import prepare
from passo.hub.views import FileView

_T = TypeVar("_T", bound=Struct)
HUB = "hub"  # who acts where no user does

RUNS: Final = Table(RunRow, "runs", "id")
JOBS: Final = Table(JobRow, "jobs", "id")
_TABLES: Final[Mapping[type[Struct], Table[Any]]] = {
    table.kind: table
    for table in (
        Table(PrinterRow, "printers", "id"),
        Table(FileView, "files", "sha256"),
        JOBS,
        RUNS,
        Table(GroupRow, "power_groups", "name"),
        Table(ServiceRow, "service_items", "printer", "item"),
        Table(SettingRow, "settings", "name"),
    )
}
_IN_MEMORY: Mapping[type[Struct], str] = {
    JobRow: "where over_s is null order by number",
    RunRow: "where job in (select id from jobs where over_s is null) order by assigned_s, rowid",
}


class WrongState(Exception):
    """A run is not in the state that a transition leaves: the code has lost track of it."""


def _failed(error: Exception) -> HubError:
    return HubError.of("hub.store", value=str(error))


class Store:
    """The data of one farm. Raises HubError if they cannot be used or written: then nothing has
    changed."""

    def __init__(self, base: sqlite3.Connection, wall_s: Callable[[], float] = time) -> None:
        """`base` is a connection without implicit transactions. `wall_s` is the wall clock."""
        self._base, self._wall_s = base, wall_s
        self.listeners: list[Callable[[], None]] = []  # called after each change
        self._memory: dict[type[Struct], dict[Any, Any]] = {kind: {} for kind in _TABLES}
        self._runs_of: dict[str, dict[str, RunRow]] = {}
        self._active: dict[str, str] = {}
        try:
            prepare(base)
            for kind, table in _TABLES.items():
                sql = f"select {table.columns} from {table.name} {_IN_MEMORY.get(kind, '')}"
                for row in base.execute(sql):
                    self._keep(table.row(row))
            self._last_job: int = base.execute("select max(number) from jobs").fetchone()[0] or 0
        except sqlite3.Error as error:
            base.close()
            raise _failed(error) from None
        except HubError:
            base.close()
            raise

    @classmethod
    def open(cls, path: Path | None, wall_s: Callable[[], float] = time) -> Store:
        """The data in a file, which is made if it does not exist; None is a store in memory."""
        try:
            if path is not None:
                # The keys of the printers are in it; SQLite gives its other files the same mode.
                os.close(os.open(path, os.O_CREAT | os.O_RDWR, 0o600))
            name = ":memory:" if path is None else path
            return cls(sqlite3.connect(name, timeout=1.0, isolation_level=None), wall_s)
        except (OSError, sqlite3.Error) as error:
            raise _failed(error) from None

    @property
    def printers(self) -> Mapping[str, PrinterRow]:
        """All printers, by id."""
        return self._memory[PrinterRow]

    @property
    def files(self) -> Mapping[str, FileView]:
        """All files, by SHA-256."""
        return self._memory[FileView]

    @property
    def jobs(self) -> Mapping[str, JobRow]:
        """The open jobs, by id."""
        return self._memory[JobRow]

    @property
    def runs(self) -> Mapping[str, RunRow]:
        """The runs of open jobs, by id."""
        return self._memory[RunRow]

    @property
    def groups(self) -> Mapping[str, GroupRow]:
        """The power groups, by name."""
        return self._memory[GroupRow]

    @property
    def service_items(self) -> Mapping[tuple[str, str], ServiceRow]:
        """The maintenance items, by printer and item."""
        return self._memory[ServiceRow]

    @property
    def queue_paused(self) -> bool:
        """Whether nothing starts."""
        row = self._memory[SettingRow].get("queue_paused")
        return row is not None and row.value == "1"

    def runs_of(self, job: str) -> Mapping[str, RunRow]:
        """The runs of an open job, by id."""
        return self._runs_of.get(job, {})

    def active_run(self, printer: str) -> RunRow | None:
        """The run on a printer that is not over."""
        run = self._active.get(printer)
        return self.runs[run] if run is not None else None

    @property
    def active_runs(self) -> list[RunRow]:
        """The runs that are not over, at most one on a printer."""
        runs = self.runs
        return [runs[run] for run in self._active.values()]

    def is_free(self, printer: str) -> bool:
        """Whether no run is on a printer."""
        return printer not in self._active

    def next_number(self) -> int:
        """A number for a new job, greater than all others."""
        self._last_job += 1
        return self._last_job

    @contextmanager
    def change(self, user: str, what: str = "", **about: str) -> Generator[Change]:
        """One transaction. `what` is its line in the log, about a printer, a job or a run; without
        it there is no line. Nothing has changed if the block raises."""
        change = Change(self._base, self._memory)
        try:
            self._base.execute("begin immediate")
            yield change
            if what:
                change.note(what, **about)
            for text, ids in change.notes:
                self._base.execute(
                    "insert into events (time_s, who, what, printer, job, run)"
                    " values (?, ?, ?, ?, ?, ?)",
                    (self._wall_s(), user or HUB, text, *ids),
                )
            self._base.execute("commit")
        except BaseException as error:
            with suppress(sqlite3.Error):
                self._base.execute("rollback")
            if isinstance(error, sqlite3.Error):
                raise _failed(error) from None
            raise
        for row in change.removed:
            self._forget(row)
        for row in change.written.values():
            self._keep(row)
        for changed in self.listeners:
            changed()

    def select(self, table: Table[_T], condition: str, values: tuple[Any, ...]) -> list[_T]:
        """Rows of the history."""
        sql = f"select {table.columns} from {table.name} {condition}"
        return [table.row(cells) for cells in self.query(sql, values)]

    def query(self, sql: str, values: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
        """The rows of a question."""
        try:
            return self._base.execute(sql, values).fetchall()
        except sqlite3.Error as error:
            raise _failed(error) from None

    def close(self) -> None:
        """Closes the file; no method may be called after that."""
        self._base.close()

    def _keep(self, row: Struct) -> None:
        if isinstance(row, JobRow) and row.over_s is not None:
            self._forget(row)
            return
        table = _TABLES[type(row)]
        self._memory[type(row)][_key(table, row)] = row
        if isinstance(row, RunRow):
            if row.job not in self.jobs:
                self._memory[RunRow].pop(row.id, None)
            else:
                self._runs_of.setdefault(row.job, {})[row.id] = row
            if not row.state.over:
                self._active[row.printer] = row.id
            elif self._active.get(row.printer) == row.id:
                del self._active[row.printer]

    def _forget(self, row: Struct) -> None:
        self._memory[type(row)].pop(_key(_TABLES[type(row)], row), None)
        if isinstance(row, JobRow):
            for run in self._runs_of.pop(row.id, {}):
                self._memory[RunRow].pop(run, None)


class Change:
    """One transaction of a store. It writes at once, and the memory of the store follows at its
    end."""

    def __init__(
        self, base: sqlite3.Connection, memory: Mapping[type[Struct], Mapping[Any, Any]]
    ) -> None:
        self._base, self._memory = base, memory
        self.written: dict[tuple[type[Struct], Any], Struct] = {}
        self.removed: list[Struct] = []
        self.notes: list[tuple[str, tuple[str, str, str]]] = []

    def note(self, what: str, printer: str = "", job: str = "", run: str = "") -> None:
        """A line for the log; it is written at the end of the transaction."""
        self.notes.append((what, (printer, job, run)))

    def add(self, row: Struct) -> None:
        """Adds a row; an equal key is an error of SQLite."""
        table = _TABLES[type(row)]
        self._base.execute(table.insert, table.cells(row))
        self.written[type(row), _key(table, row)] = row

    def set(self, row: _T, **fields: Any) -> _T:
        """Changes some fields of a stored row, and returns it."""
        table = _TABLES[type(row)]
        self._update(table, fields, table.where, table.key_of(row))
        return self._now(row, fields)

    def remove(self, row: Struct) -> None:
        """Removes a row."""
        table = _TABLES[type(row)]
        self._base.execute(f"delete from {table.name} where {table.where}", table.key_of(row))
        self.removed.append(row)

    def setting(self, name: str, value: str) -> None:
        """Stores a setting of the farm."""
        self._base.execute("delete from settings where name = ?", (name,))
        self.add(SettingRow(name, value))

    def move(self, run: RunRow, old: RunState, new: RunState, **fields: Any) -> RunRow:
        """A transition of a run. Raises WrongState if the stored run is not in the state `old`, or
        if `new` does not follow it."""
        if new not in TRANSITIONS[old]:
            raise WrongState(f"run {run.id}: {new.value} does not follow {old.value}")
        fields |= {"state": new}
        self._update(RUNS, fields, "id = ? and state = ?", (run.id, old.value))
        return self._now(run, fields)

    def _update(
        self, table: Table[Any], fields: Mapping[str, Any], where: str, key: Sequence[Any]
    ) -> None:
        names = ", ".join(f"{name} = ?" for name in fields)
        sql = f"update {table.name} set {names} where {where}"
        found = self._base.execute(sql, (*map(cell, fields.values()), *key))
        if found.rowcount != 1:
            raise WrongState(f"no row of {table.name} is {key}")

    def now(self, row: _T) -> _T:
        """A row with the changes of this transaction."""
        key = type(row), _key(_TABLES[type(row)], row)
        return cast(_T, self.written.get(key) or self._memory[type(row)].get(key[1], row))

    def _now(self, row: _T, fields: Mapping[str, Any]) -> _T:
        new = replace(self.now(row), **fields)
        self.written[type(row), _key(_TABLES[type(row)], row)] = new
        return new


def _key(table: Table[Any], row: Struct) -> Any:
    key = table.key_of(row)
    return key[0] if len(key) == 1 else tuple(key)
