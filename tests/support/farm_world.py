"""A farm of fake printers in virtual time, with a hub that can be killed at any moment."""

from __future__ import annotations

import asyncio
import atexit
import hashlib
import logging
import shutil
import sqlite3
import tempfile
from collections.abc import Awaitable, Callable
from functools import cache
from pathlib import Path
from random import Random
from typing import Any, TypeVar
from uuid import UUID

from tests.support.fake_printer import FakeLink, FakePrinter, Network

from passo.clock import VirtualLoop
from passo.hub.farm import Farm, fits_always
from passo.hub.link import PrinterRecord
from passo.hub.matching import Fits
from passo.hub.store import Store
from passo.hub.views import FileView, JobView, PrinterView
from passo.hub.wishes import NewJob

_T = TypeVar("_T")
EPOCH_S = 1_800_000_000.0
USER = "anna"


@cache
def _folder() -> Path:
    """The contents of all files, for all farms of this process."""
    folder = tempfile.mkdtemp()
    atexit.register(shutil.rmtree, folder)
    return Path(folder)


class Killed(BaseException):
    """The process of the hub has ended here."""


class Disk(sqlite3.Connection):
    """A connection that survives the hub, and can kill it at a commit."""

    def __init__(self, *args: Any, **options: Any) -> None:
        super().__init__(*args, **options)
        self.commits = 0
        self.dead = self.full = False
        self.at_commit: Callable[[int, bool], None] = lambda number, durable: None

    def execute(self, sql: str, *values: Any) -> sqlite3.Cursor:
        if self.dead:
            raise Killed
        if sql != "commit":
            return super().execute(sql, *values)
        if self.full:
            raise sqlite3.OperationalError("database or disk is full")
        number = self.commits
        self.at_commit(number, False)
        found = super().execute(sql, *values)
        self.commits += 1
        self.at_commit(number, True)
        return found

    def revive(self) -> None:
        """Another process opens the file: what was not committed is gone."""
        self.dead = False
        if self.in_transaction:
            self.rollback()


class World:
    """Fake printers, a disk and a hub."""

    def __init__(
        self,
        printers: list[FakePrinter],
        seed: int = 0,
        network: Network | None = None,
        fits: Fits = fits_always,
    ) -> None:
        self.printers = {printer.id: printer for printer in printers}
        self.chance, self.network, self._fits = Random(seed), network or Network(), fits
        self.disk = sqlite3.connect(":memory:", isolation_level=None, factory=Disk)
        self.contents = _folder()
        self.killed = asyncio.Event()
        self.kills = 0
        self.link_calls = 0
        self.at_link: Callable[[int, bool], None] = lambda number, answered: None
        self._ids = Random(seed)
        self.farm = self._new_farm()

    def wall_s(self) -> float:
        return EPOCH_S + asyncio.get_running_loop().time()

    def _new_farm(self) -> Farm:
        self.store = Store(self.disk, self.wall_s)
        return Farm(
            self.store,
            self._link,
            lambda sha256: self.contents / sha256,
            self._fits,
            self.wall_s,
            Random(self._ids.random()),
            lambda: str(UUID(int=self._ids.getrandbits(128))),
        )

    def _link(self, record: PrinterRecord) -> FakeLink:
        life = self.kills

        def called() -> int:
            if life != self.kills or self.disk.dead:
                raise Killed
            self.link_calls += 1
            self.at_link(self.link_calls - 1, False)
            return self.link_calls - 1

        def answered(number: int) -> None:
            if life == self.kills and not self.disk.dead:
                self.at_link(number, True)

        return FakeLink(self.printers[record.id], self.chance, self.network, called, answered)

    async def start(self, **fields: Any) -> None:
        """Starts the hub and adds the printers."""
        await self.farm.start()
        for printer in self.printers.values():
            await self.add(printer)
        await asyncio.sleep(10.0)

    async def add(self, printer: FakePrinter, *tags: str) -> None:
        """Adds a printer to the farm."""
        self.printers[printer.id] = printer
        record = PrinterRecord(printer.id, printer.name, f"http://{printer.name}", "passo", "key")
        await self.farm.add_printer(record, tags, "admin")

    def kill(self) -> None:
        """Kills the hub here: nothing of it acts any more."""
        self.disk.dead = True
        self.killed.set()
        raise Killed

    async def restart(self) -> None:
        """Starts a hub on the same disk."""
        dead = self.farm
        self.disk.dead = True
        self.kills += 1
        await dead.close()
        self.disk.revive()
        self.killed.clear()
        self.farm = self._new_farm()
        await self.farm.start()

    async def file(self, name: str = "part.gcode", **fields: Any) -> str:
        """Adds a file; returns its SHA-256."""
        sha256 = hashlib.sha256(name.encode()).hexdigest()
        if not (content := _folder() / sha256).exists():
            content.write_text(name)
        await self.farm.add_file(FileView(sha256, name, 1000, self.wall_s(), **fields), USER)
        return sha256

    async def job(self, name: str = "part.gcode", user: str = USER, **fields: Any) -> JobView:
        """Adds a file, and a job for it."""
        sha256 = await self.file(name)
        return await self.farm.add_job(NewJob(sha256, **fields), user)

    async def clear(self, *printers: FakePrinter) -> None:
        """A user takes the print from the bed, then says so."""
        for printer in printers or tuple(self.printers.values()):
            printer.on_bed = False
            await self.farm.clear(printer.id, USER)

    def shown(self, printer: FakePrinter) -> PrinterView:
        """A printer in the view of the farm."""
        return self.farm.printer(printer.id)

    def states(self) -> dict[str, str]:
        """The state of each run, by id."""
        return dict(self.store.query("select id, state from runs order by rowid"))

    def log(self) -> list[tuple[Any, ...]]:
        """The whole log of the farm."""
        return self.store.query("select * from events order by number")

    def starts(self) -> list[tuple[float, str, str]]:
        """All starts that took effect: when, which run, where."""
        return sorted(
            (start.at_s, start.run, printer.name)
            for printer in self.printers.values()
            for start in printer.starts
        )


def play(test: Callable[[], Awaitable[_T]]) -> _T:
    """Runs a test in virtual time."""
    loop = VirtualLoop()

    def failed(loop: asyncio.AbstractEventLoop, context: dict[str, Any]) -> None:
        if not isinstance(context.get("exception"), Killed):
            loop.default_exception_handler(context)

    loop.set_exception_handler(failed)
    logger, errors = logging.getLogger("passo.hub"), _Errors()
    logger.addHandler(errors)
    try:
        return loop.run_until_complete(_main(test))
    finally:
        logger.removeHandler(errors)
        loop.close()
        assert errors.lines == []


class _Errors(logging.Handler):
    """The errors that the hub logs: its own faults, which nothing else shows."""

    def __init__(self) -> None:
        super().__init__(logging.ERROR)
        self.lines: list[str] = []

    def emit(self, record: logging.LogRecord) -> None:
        if "disk is full" not in record.getMessage():
            self.lines.append(self.format(record))


async def _main(test: Callable[[], Awaitable[_T]]) -> _T:
    try:
        return await test()
    finally:
        others = asyncio.all_tasks() - {asyncio.current_task()}
        for task in others:
            task.cancel()
        await asyncio.gather(*others, return_exceptions=True)
