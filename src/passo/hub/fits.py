"""Whether files fit printers: the check and the estimate of each machine, in a process of low
priority."""

from __future__ import annotations

import asyncio
import hashlib
import logging
from collections.abc import Awaitable, Callable
from functools import partial
from io import FileIO
from pathlib import Path
from typing import TYPE_CHECKING

from passo.config.load import load_text
from passo.errors import ConfigError, PassoError, in_words
from passo.hub.link import Refused, Unreachable
from passo.hub.matching import Fit
from passo.library.planning import Planning
from passo.library.planning_work import find_verdict
from passo.printer.unfit_commands import Skips

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig
    from passo.job.batch.verdict import Verdict

_log = logging.getLogger(__name__)

_ASK_AGAIN_S = 300.0  # after that, a printer is asked for its machine file again
_RETRY_S = 30.0  # after a printer did not answer
_NO_MACHINE = ""

Machines = Callable[[str], Awaitable[str]]  # the machine file of a printer, by its id


class FileFits:
    """Answers from what is known, and finds out the rest: call it like `matching.Fits`. Use it in
    one event loop."""

    def __init__(
        self,
        machines: Machines,
        content: Callable[[str], Path],
        known: Callable[[], object],
        work: Callable[[str, Path], Fit],
    ) -> None:
        """`content` is the path of a file; `known` is called when more is known; `work` finds out
        whether a file fits a machine, in another thread."""
        self._machines, self._content = machines, content
        self._known, self._work = known, work
        self._texts: dict[str, str] = {}  # machine files by hash
        self._hashes: dict[str, str] = {}  # of printers
        self._asked_s: dict[str, float] = {}
        self._fits: dict[tuple[str, str], Fit] = {}
        self._wanted: dict[tuple[str, str], None] = {}  # the newest is the last
        self._tasks: set[asyncio.Task[None]] = set()
        self._working = False

    def __call__(self, sha256: str, printer: str) -> Fit | None:
        """Whether a file fits a printer; None while that is not known."""
        self._ask(printer)
        machine = self._hashes.get(printer)
        if machine is None:
            return None
        if machine == _NO_MACHINE:
            return Fit(fits=True)
        key = sha256, machine
        if (found := self._fits.get(key)) is None:
            self._wanted.setdefault(key)
            if not self._working:
                self._working = True
                self._start(self._work_all())
        return found

    async def close(self) -> None:
        """Ends all work."""
        for task in list(self._tasks):
            task.cancel()
        await asyncio.gather(*self._tasks, return_exceptions=True)

    def _start(self, work: Awaitable[None]) -> None:
        task = asyncio.ensure_future(work)
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)

    def _ask(self, printer: str) -> None:
        now_s = asyncio.get_running_loop().time()
        if now_s >= self._asked_s.get(printer, 0.0):
            self._asked_s[printer] = now_s + _ASK_AGAIN_S
            self._start(self._fetch(printer))

    async def _fetch(self, printer: str) -> None:
        try:
            text = await self._machines(printer)
        except Unreachable:
            self._asked_s[printer] = asyncio.get_running_loop().time() + _RETRY_S
            return
        except Refused as refusal:
            _log.warning("The machine file of printer %s is not known: %s", printer, refusal)
            text = ""
        hash_ = hashlib.sha256(text.encode()).hexdigest() if text else _NO_MACHINE
        self._texts[hash_] = text
        if self._hashes.get(printer) != hash_:
            self._hashes[printer] = hash_
            self._known()

    async def _work_all(self) -> None:
        try:
            while self._wanted:
                key = next(reversed(self._wanted))
                sha256, machine = key
                fit = await asyncio.to_thread(
                    self._work, self._texts[machine], self._content(sha256)
                )
                self._fits[key] = fit
                del self._wanted[key]
                self._known()
        finally:
            self._working = False


def find_fit(text: str, path: Path) -> Fit:
    """Whether a file fits a machine: what `passo check` and `passo estimate` say. Blocks until a
    process of low priority has planned the file."""
    try:
        machine = load_text(text, "machine file")
    except ConfigError as error:
        # It may refer to files that only the printer has.
        _log.warning("A machine file cannot be checked here: %s", error)
        return Fit(fits=True)
    try:
        verdict = _verdict(machine, path)
    except (PassoError, OSError, RuntimeError) as error:
        return Fit(fits=False, why=in_words(error).problems[0].sentence)
    if verdict.problems:
        first = verdict.problems[0]
        place = f"line {first.line}: " if first.line else ""
        return Fit(fits=False, why=place + first.sentence)
    return Fit(True, print_s=verdict.estimate.total_s if verdict.estimate else None)


def _verdict(machine: MachineConfig, path: Path) -> Verdict:
    work = partial(find_verdict, machine, Skips(), {}, path.name)
    with FileIO(path) as source:
        return Planning(work, source, path.stat().st_size).run()
