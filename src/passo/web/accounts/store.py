"""Accounts, log-ins and keys in SQLite, in a separate thread; or only in memory."""

from __future__ import annotations

import asyncio
import os
import sqlite3
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

from passo.errors import WebError

_SCHEMA = """
create table if not exists site (instance text not null);
create table if not exists accounts (
    name text primary key, role integer not null, password text not null
);
create table if not exists sessions (
    hash text primary key, account text not null, started_s real not null, used_s real not null
);
create table if not exists keys (
    hash text primary key, id text not null, name text not null, role integer not null,
    made_s real not null
);
"""


class Store:
    """The file `accounts.sqlite` in a folder, readable only by its owner. Without a folder,
    accounts exist only in memory. The changes of `write` survive a power cut."""

    def __init__(self, folder: Path | None, *, more: str = "") -> None:
        """`more` are the statements that make further tables. Raises WebError if the file cannot be
        used."""
        self._thread = ThreadPoolExecutor(1, "accounts")
        self._base: sqlite3.Connection | None = None
        if folder is None:
            return
        path = folder / "accounts.sqlite"
        try:
            folder.mkdir(parents=True, exist_ok=True)
            os.close(os.open(path, os.O_CREAT | os.O_RDWR, 0o600))
            self._base = self._thread.submit(_opened, path, more).result()
        except (sqlite3.Error, OSError) as error:
            self._thread.shutdown()
            raise WebError.of("web.accounts", str(path), value=error) from None

    @property
    def kept(self) -> bool:
        """Whether accounts survive a restart of the program."""
        return self._base is not None

    def rows(self, query: str) -> list[tuple[Any, ...]]:
        """All rows of a query. Blocks; call it only while the program starts."""
        base = self._base
        if base is None:
            return []

        def run() -> list[tuple[Any, ...]]:
            return base.execute(query).fetchall()

        return self._thread.submit(run).result()

    async def write(self, *statements: tuple[str, tuple[object, ...]]) -> None:
        """Executes statements as one transaction. Raises WebError; then none of them has an
        effect."""
        base = self._base
        if base is None:
            return

        def run() -> None:
            with base:
                for statement, values in statements:
                    base.execute(statement, values)

        try:
            await asyncio.get_running_loop().run_in_executor(self._thread, run)
        except sqlite3.Error as error:
            raise WebError.of("web.accounts", value=error) from None

    def close(self) -> None:
        """Closes the file; no method may be called after that."""
        if self._base is not None:
            self._thread.submit(self._base.close).result()
        self._thread.shutdown()


def _opened(path: Path, more: str) -> sqlite3.Connection:
    base = sqlite3.connect(path)
    try:
        base.execute("pragma journal_mode = wal")
        base.execute("pragma synchronous = full")
        base.executescript(_SCHEMA + more)
    except sqlite3.Error:
        base.close()
        raise
    return base
